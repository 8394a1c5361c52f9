/* Leads haptolith's tool along a circle through its network device, and prints the force that a hand would feel.
 *
 *     haptolith run --device network                                            in one terminal
 *     cc -Iinclude examples/c/network_device.c -lm -o circle && ./circle        in another
 *
 * circle [ADDRESS [SECONDS [HEIGHT_MM]]], default 127.0.0.1:9050, 10 s and -90 mm. The height of the circle is in the device's frame,
* whose origin is 85 mm above the soil. Needs POSIX sockets and a little-endian machine; does not support keys. */
#define _POSIX_C_SOURCE 200112L
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <haptolith/network_device.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

#define RADIUS_M 0.02
#define TURN_RAD_S 1.5707963267948966 /* one round in 4 s */

static int failed(const char *why) {
  fprintf(stderr, "network_device: %s\n", why);
  return 1;
}

static uint64_t now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

/* Returns a non-blocking socket connected to HOST:PORT; -1 for an invalid address. */
static int connected_to(const char *address) {
  struct sockaddr_in to = {0};
  char host[64] = "";
  int port = 0, udp = socket(AF_INET, SOCK_DGRAM, 0);
  if (sscanf(address, "%63[^:]:%d", host, &port) != 2 || inet_pton(AF_INET, host, &to.sin_addr) != 1) return -1;
  to.sin_family = AF_INET;
  to.sin_port = htons((uint16_t)port);
  if (udp < 0 || connect(udp, (struct sockaddr *)&to, sizeof to) != 0) return -1;
  fcntl(udp, F_SETFL, O_NONBLOCK);
  return udp;
}

/* Sets the tool's pose and velocity after t_s. */
static void go_round(double t_s, double height_m, hapto_network_packet *packet) {
  const double c = cos(TURN_RAD_S * t_s), s = sin(TURN_RAD_S * t_s);
  packet->position_m[0] = RADIUS_M * c;
  packet->position_m[1] = RADIUS_M * s;
  packet->position_m[2] = height_m;
  packet->velocity_m_s[0] = -RADIUS_M * TURN_RAD_S * s;
  packet->velocity_m_s[1] = RADIUS_M * TURN_RAD_S * c;
}

/* Reads the newest received answer. Returns 1; 0 without an answer; -1 if the port is not open. */
static int newest_answer(int udp, hapto_network_answer *newest) {
  hapto_network_answer answer;
  ssize_t size;
  int got = 0;
  while ((size = recv(udp, &answer, sizeof answer, MSG_TRUNC)) >= 0) {
    if (size != sizeof answer || memcmp(answer.magic, HAPTO_NETWORK_ANSWER_MAGIC, 4) != 0) continue;
    if (answer.version != HAPTO_NETWORK_VERSION) continue;
    *newest = answer;
    got = 1;
  }
  return errno == ECONNREFUSED ? -1 : got;
}

int main(int argc, char **argv) {
  const int udp = connected_to(argc > 1 ? argv[1] : "127.0.0.1:9050");
  const double seconds = argc > 2 ? atof(argv[2]) : 10, height_m = (argc > 3 ? atof(argv[3]) : -90) / 1000;
  const struct timespec tick = {0, 1000000};
  hapto_network_packet packet = {HAPTO_NETWORK_PACKET_MAGIC, HAPTO_NETWORK_VERSION, HAPTO_NETWORK_HELD};
  hapto_network_answer answer = {{0}};
  const uint64_t start = now_ns();
  uint64_t now, answered = start, printed = start;
  unsigned long answers = 0;
  double strongest_n = 0;
  if (udp < 0) return failed("the address must be an IPv4 address with a port, as in 127.0.0.1:9050");
  packet.orientation_wxyz[0] = 1;
  while ((now = now_ns()) < start + (uint64_t)(seconds * 1e9)) {
    const double *f = answer.force_n;
    int got;
    go_round((double)(now - start) * 1e-9, height_m, &packet);
    packet.sender_time = now;
    if (send(udp, &packet, sizeof packet, 0) < 0 && errno == ECONNREFUSED) break;
    ++packet.sequence;
    got = newest_answer(udp, &answer);
    if (got < 0) break;
    if (got) {
      answered = now;
      ++answers;
      strongest_n = fmax(strongest_n, sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]));
    } else if (now - answered > HAPTO_NETWORK_SILENCE_MS * 1000000u) {
      memset(&answer, 0, sizeof answer); /* a device that pushes a hand must be sent zero force here */
    }
    if (got && now - printed > 100000000) {
      printed = now;
      printf("force %7.3f %7.3f %7.3f N  round trip %6.2f ms  %s\n", f[0], f[1], f[2],
             (double)(now_ns() - answer.sender_time) * 1e-6,
             answer.flags & HAPTO_NETWORK_TRIPPED ? "tripped" : answer.flags & HAPTO_NETWORK_LIVE ? "live" : "not held");
    }
    nanosleep(&tick, NULL);
  }
  if (answers == 0) return failed("nobody answers: start `haptolith run --device network` first, or name its address");
  printf("%u packets sent, %lu answers, strongest force %.3f N\n", (unsigned)packet.sequence, answers, strongest_n);
  return 0;
}
