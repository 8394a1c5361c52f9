/* Packets of the network device, for programs that hold the tool by UDP: docs/reference/udp.md.
 *
 * A program sends hapto_network_packet about a thousand times a second to where `haptolith run --device network` listens,
 * 127.0.0.1:9050, and is sent at most one hapto_network_answer for each, after a tick.
 *
 * Byte order: little-endian, numbers IEEE 754, no gaps. This header needs no library; structures have in memory the
 * layout of packets on the wire, on little-endian machines, so that send(), recv() and memcpy() read and write them.
 * Frame: the sender's own, right-handed. A scene's [mapping] puts it into the scene; left out, x is to the right, y away
 * from who looks and z up, and the origin lies 85 mm above the middle of the soil.
 * Units: m, s, rad, N. Velocities are those of the pose in the same packet; all zeros make soil feel undamped.
 *
 * A program that renders force must set it to zero when no answer has arrived for HAPTO_NETWORK_SILENCE_MS: haptolith may be gone.
 *
 * With a key, HAPTO_NETWORK_TAG_BYTES follow a sent packet, and a nonce and a tag of that size each follow an answer:
 * docs/reference/udp.md has their content.
 */
#ifndef HAPTOLITH_NETWORK_DEVICE_H
#define HAPTOLITH_NETWORK_DEVICE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HAPTO_NETWORK_PORT 9050
#define HAPTO_NETWORK_VERSION 1
#define HAPTO_NETWORK_PACKET_MAGIC "HLDV"
#define HAPTO_NETWORK_ANSWER_MAGIC "HLAN"
#define HAPTO_NETWORK_SILENCE_MS 20 /* without packets the hand feels nothing; without answers it must not */
#define HAPTO_NETWORK_NONCE_BYTES 16
#define HAPTO_NETWORK_TAG_BYTES 16

/* Flags of what is sent. */
#define HAPTO_NETWORK_HELD 1u /* the dead-man switch; without it the hand feels nothing and the tool stays */

/* Flags of answers. */
#define HAPTO_NETWORK_LIVE 1u   /* the sender is trusted: its packets are fresh and its switch is held */
#define HAPTO_NETWORK_TRIPPED 2u /* the watchdog or a crash has set the forces to zero, and they stay so */
#define HAPTO_NETWORK_LET_GO HAPTO_NETWORK_TRIPPED /* deprecated */

/* The sent packet. */
typedef struct hapto_network_packet {
  char magic[4];                    /* HAPTO_NETWORK_PACKET_MAGIC, without its 0 */
  uint16_t version;                 /* HAPTO_NETWORK_VERSION */
  uint16_t flags;                   /* HAPTO_NETWORK_HELD */
  uint32_t sequence;                /* one more with each packet; after 4294967295 comes 0 */
  uint32_t buttons;                 /* bit n: button n is down */
  uint64_t sender_time;             /* returned in the answer; in the sender's own unit */
  double position_m[3];             /* of the handle's origin; each within 10 m */
  double orientation_wxyz[4];       /* turns the handle's frame into the sender's; of unit length within 1 % */
  double velocity_m_s[3];           /* each within 100 m/s */
  double angular_velocity_rad_s[3]; /* each within 1000 rad/s */
  double gripper_open;              /* 0 closed to 1 wide open */
} hapto_network_packet;

/* The answer. */
typedef struct hapto_network_answer {
  char magic[4];          /* HAPTO_NETWORK_ANSWER_MAGIC, without its 0 */
  uint16_t version;       /* HAPTO_NETWORK_VERSION */
  uint16_t flags;         /* HAPTO_NETWORK_LIVE, HAPTO_NETWORK_TRIPPED */
  uint32_t sequence;      /* of the newest packet that was taken */
  uint32_t number;        /* of this answer, one more with each */
  uint64_t sender_time;   /* the sender's, in that packet: now less this is the round trip */
  double force_n[3];      /* on the hand */
  double torque_nm[3];    /* on the hand, about the handle's origin */
  double gripper_force_n; /* > 0 opens the fingers */
} hapto_network_answer;

/* These do not compile where a structure is not as large as its packet. */
typedef char hapto_network_packet_has_136_bytes[sizeof(hapto_network_packet) == 136 ? 1 : -1];
typedef char hapto_network_answer_has_80_bytes[sizeof(hapto_network_answer) == 80 ? 1 : -1];

#ifdef __cplusplus
}
#endif

#endif
