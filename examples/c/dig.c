/* Presses a shovel into lunar soil and prints the force on it. */
#include <haptolith/haptolith.h>
#include <stdio.h>

static int failed(const char *what) {
  hapto_error error = {sizeof error, 0, "", "", "", ""};
  hapto_last_error(&error);
  fprintf(stderr, "%s: %s\n", what, error.message);
  return 1;
}

int main(void) {
  const char *overrides[] = {"soil.preset=P3", "gravity.body=Moon"};
  hapto_scene *scene = NULL;
  hapto_scene_info info = {sizeof info};
  hapto_pose tool = {{0, 0, 0}, {1, 0, 0, 0}};
  hapto_wrench felt;
  int tick;
  if (hapto_scene_from_file("icra2021", overrides, 2, NULL, NULL, &scene) != HAPTO_OK) return failed("scene");
  if (hapto_scene_get_info(scene, &info) != HAPTO_OK) return failed("info");
  tool.position_m[2] = info.surface_m + 0.01;
  hapto_scene_place_tool(scene, &tool);
  for (tick = 0; tick <= 400; ++tick) { /* 40 mm at 0.1 m/s */
    if (hapto_scene_step(scene, &tool, NULL, &felt) != HAPTO_OK) return failed("step");
    if (tick % 100 == 0) printf("%5.1f mm  %6.3f N\n", (info.surface_m - tool.position_m[2]) * 1e3, felt.force_n[2]);
    tool.position_m[2] -= 1e-4;
  }
  hapto_scene_destroy(scene);
  return 0;
}
