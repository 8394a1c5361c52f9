/* Runs a scene's hand for 1 s, as `haptolith run SCENE --no-realtime --duration-s 1 --json` does, and prints the hash of the soil
* afterwards, which is equal to the program's. */
#define _POSIX_C_SOURCE 199309L
#include <haptolith/haptolith.h>
#include <inttypes.h>
#include <stdio.h>
#include <time.h>

static void require(int32_t status, const char *what) {
  if (status != HAPTO_OK) {
    hapto_error error = {sizeof error, 0, "", "", "", ""};
    hapto_last_error(&error);
    fprintf(stderr, "%s: %s: %s\n", what, hapto_status_text(status), error.message);
  }
}

int main(int argc, char **argv) {
  const char *overrides[] = {"loop.real_time=false", "loop.duration_s=1"};
  const struct timespec moment = {0, 1000000};
  hapto_scene *scene = NULL;
  hapto_loop *loop = NULL;
  hapto_snapshot now = {sizeof now};
  uint64_t hash = 0;
  require(hapto_scene_from_file(argc > 1 ? argv[1] : "icra2021", overrides, 2, NULL, NULL, &scene), "scene");
  require(hapto_loop_create(scene, NULL, 0, &loop), "loop");
  require(hapto_loop_start(loop), "start");
  do {
    nanosleep(&moment, NULL);
    require(hapto_loop_snapshot(loop, &now), "snapshot");
  } while (now.running);
  require(hapto_loop_destroy(loop), "loop");
  require(hapto_scene_state_hash(scene, &hash), "hash");
  require(hapto_scene_destroy(scene), "scene");
  printf("%016" PRIx64 "\n", hash);
  return hash == 0;
}
