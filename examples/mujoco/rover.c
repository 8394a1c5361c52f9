/* A rover with four driven wheels crosses soil in MuJoCo, which has its joints and motors; haptolith has the soil and what it does to
 * each wheel.
 *
 *     cc rover.c $(pkg-config --cflags --libs haptolith) -lmujoco -lm && ./a.out [SLOPE IN DEGREES [CSV]]
 *
 * Both run at 1 kHz. On a slope the gravity of both is turned, and the soil stays level. With a CSV's name, every twentieth tick is
 * written to it. */
#include <haptolith/haptolith.h>
#include <math.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WHEELS = 4 };

static const double gravity_m_s2 = 1.625, rim_m = 0.04, rim_speed_m_s = 0.08, begins_s = 1, lasts_s = 9;

/* The axle of a wheel is its body's z, as it is of haptolith's model "wheel". */
#define WHEEL(name, x, y)                                                                             \
  "<body name='" name "' pos='" x " " y " -0.03' euler='-90 0 0'>"                                    \
  "  <joint name='" name "' axis='0 0 1' damping='0.001' armature='0.0005'/>"                         \
  "  <geom type='cylinder' size='0.035 0.018' mass='0.2'/></body>"
static const char rover[] =
    "<mujoco model='rover'>"
    "  <option timestep='0.001' integrator='implicit'/>"
    "  <default><geom contype='0' conaffinity='0'/></default>"
    "  <worldbody>"
    "    <body name='chassis' pos='-0.36 0 0.2'><freejoint/>"
    "      <geom type='box' size='0.11 0.06 0.02' mass='2.2'/>" WHEEL("front-left", "0.1", "0.09") WHEEL("front-right", "0.1", "-0.09")
        WHEEL("back-left", "-0.1", "0.09") WHEEL("back-right", "-0.1", "-0.09")
    "    </body>"
    "  </worldbody>"
    "  <actuator>"
    "    <velocity joint='front-left' kv='0.5'/><velocity joint='front-right' kv='0.5'/>"
    "    <velocity joint='back-left' kv='0.5'/><velocity joint='back-right' kv='0.5'/>"
    "  </actuator>"
    "</mujoco>";

static const char soil[] =
    "[soil]\nname = 'lunar-0-15cm'\nradius_mm = 7\n"
    "[bed]\nstart = 'settled'\nwidth_mm = 1100\nlength_mm = 320\ndepth_mm = 70\n"
    "[tool]\nmodel = 'wheel'\n"
    "[[tools]]\nname = 'front-left'\n[[tools]]\nname = 'front-right'\n"
    "[[tools]]\nname = 'back-left'\n[[tools]]\nname = 'back-right'\n";

static int failed(const char *what) {
  hapto_error error = {sizeof error, 0, "", "", "", ""};
  hapto_last_error(&error);
  fprintf(stderr, "%s: %s\n", what, error.message);
  return 1;
}

int main(int argc, char **argv) {
  const double slope = (argc > 1 ? atof(argv[1]) : 0) * mjPI / 180;
  hapto_scene *scene = NULL;
  hapto_scene_info info = {sizeof info};
  if (hapto_scene_from_toml(soil, "rover", NULL, 0, NULL, NULL, &scene) != HAPTO_OK) return failed("scene");
  if (hapto_scene_get_info(scene, &info) != HAPTO_OK) return failed("info");
  const double gravity[3] = {-gravity_m_s2 * sin(slope), 0, -gravity_m_s2 * cos(slope)};
  if (hapto_scene_set_gravity(scene, gravity) != HAPTO_OK) return failed("gravity");

  char why[500] = "";
  mjVFS *files = (mjVFS *)mju_malloc(sizeof(mjVFS));
  mj_defaultVFS(files);
  mj_makeEmptyFileVFS(files, "rover.xml", (int)strlen(rover));
  memcpy(files->filedata[mj_findFileVFS(files, "rover.xml")], rover, strlen(rover));
  mjModel *model = mj_loadXML("rover.xml", files, why, sizeof why);
  if (model == NULL) {
    fprintf(stderr, "MuJoCo: %s\n", why);
    return 1;
  }
  memcpy(model->opt.gravity, gravity, sizeof gravity);
  mjData *data = mj_makeData(model);
  const int chassis = mj_name2id(model, mjOBJ_BODY, "chassis");
  int wheel[WHEELS];
  for (int k = 0; k < WHEELS; ++k) { /* the tools are in the order of the file */
    const char *name = NULL;
    if (hapto_scene_tool_name(scene, (uint32_t)k, &name) != HAPTO_OK) return failed("name");
    wheel[k] = mj_name2id(model, mjOBJ_BODY, name);
  }
  data->qpos[2] = info.surface_m + rim_m + 0.03; /* the wheels just touch the soil */
  mj_forward(model, data);
  FILE *csv = argc > 2 ? fopen(argv[2], "wx") : NULL;
  if (csv != NULL) fprintf(csv, "t_s,x_m,z_m,pitch_deg,slip,sinkage_mm,power_w\n");

  double begin_m = 0, sinkage_m = 0;
  for (int tick = 0; tick < (int)(1000 * (begins_s + lasts_s)); ++tick) {
    const double rim_rad_s = data->time < begins_s ? 0 : rim_speed_m_s / rim_m;
    if (data->time < begins_s) begin_m = data->xpos[3 * chassis];
    for (int k = 0; k < WHEELS; ++k) data->ctrl[k] = rim_rad_s;

    /* MuJoCo -> soil: pose and velocity of each wheel. */
    hapto_pose pose[WHEELS];
    hapto_twist twist[WHEELS];
    hapto_wrench felt[WHEELS];
    for (int k = 0; k < WHEELS; ++k) {
      double velocity[6]; /* angular, then linear velocity, in world axes */
      mj_objectVelocity(model, data, mjOBJ_BODY, wheel[k], velocity, 0);
      memcpy(pose[k].position_m, data->xpos + 3 * wheel[k], sizeof pose[k].position_m);
      memcpy(pose[k].orientation, data->xquat + 4 * wheel[k], sizeof pose[k].orientation);
      memcpy(twist[k].angular_rad_s, velocity, sizeof twist[k].angular_rad_s);
      memcpy(twist[k].linear_m_s, velocity + 3, sizeof twist[k].linear_m_s);
      if (tick == 0) hapto_scene_tool_place(scene, (uint32_t)k, &pose[k]);
    }
    if (hapto_scene_step_tools(scene, pose, twist, WHEELS, felt) != HAPTO_OK) return failed("step");

    /* Soil -> MuJoCo: a wheel's origin is its centre of mass, where xfrc_applied acts. */
    double power_w = 0;
    sinkage_m = 0;
    for (int k = 0; k < WHEELS; ++k) {
      memcpy(data->xfrc_applied + 6 * wheel[k], felt[k].force_n, sizeof felt[k].force_n);
      memcpy(data->xfrc_applied + 6 * wheel[k] + 3, felt[k].torque_nm, sizeof felt[k].torque_nm);
      power_w += data->actuator_force[k] * data->qvel[6 + k];
      sinkage_m = fmax(sinkage_m, info.surface_m + rim_m - pose[k].position_m[2]);
    }
    mj_step(model, data);

    double velocity[6];
    mj_objectVelocity(model, data, mjOBJ_BODY, chassis, velocity, 0);
    const double slip = rim_rad_s == 0 ? 0 : 1 - velocity[3] / rim_speed_m_s;
    const double *q = data->xquat + 4 * chassis;
    const double pitch_deg = -asin(2 * (q[0] * q[2] - q[3] * q[1])) * 180 / mjPI;
    if (csv != NULL && tick % 20 == 0)
      fprintf(csv, "%.3f,%.5f,%.5f,%.3f,%.4f,%.2f,%.4f\n", data->time, data->xpos[3 * chassis], data->xpos[3 * chassis + 2], pitch_deg,
              slip, sinkage_m * 1e3, power_w);
    if (tick % 2000 == 0)
      printf("%4.1f s  %+6.1f mm  deepest wheel %5.1f mm in the soil  motors %6.3f W\n", data->time,
             (data->xpos[3 * chassis] - begin_m) * 1e3, sinkage_m * 1e3, power_w);
  }
  printf("slope %.0f deg: drove %.0f mm of %.0f mm, deepest wheel %.0f mm in the soil\n", slope * 180 / mjPI,
         (data->xpos[3 * chassis] - begin_m) * 1e3, rim_speed_m_s * lasts_s * 1e3, sinkage_m * 1e3);
  if (csv != NULL) fclose(csv);
  mj_deleteData(data);
  mj_deleteModel(model);
  mj_deleteVFS(files);
  mju_free(files);
  hapto_scene_destroy(scene);
  return 0;
}
