/* A robot arm digs in MuJoCo: the soil's wrench on its blade is applied by xfrc_applied, and the blade's pose moves the tool.
 *
 *     cc arm_digs.c $(pkg-config --cflags --libs haptolith) -lmujoco -lm && ./a.out [CSV]
 *
 * Both run at 1 kHz. The soil's frame is 0.45 m in front of the arm's base. With a CSV's name, every tenth tick is written to it. */
#include <haptolith/haptolith.h>
#include <math.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <string.h>

static const char arm[] =
    "<mujoco model='digging arm'>"
    "  <option timestep='0.001' gravity='0 0 -1.625' integrator='implicit'/>"
    "  <default><joint damping='2' armature='0.02'/><geom contype='0' conaffinity='0'/></default>"
    "  <worldbody>"
    "    <body name='shoulder' pos='0 0 0.25'>"
    "      <joint name='lift' axis='0 1 0'/><geom type='capsule' fromto='0 0 0 0.3 0 0' size='0.02' mass='1'/>"
    "      <body name='elbow' pos='0.3 0 0'>"
    "        <joint name='bend' axis='0 1 0'/><geom type='capsule' fromto='0 0 0 0.25 0 0' size='0.018' mass='0.7'/>"
    "        <body name='blade' pos='0.25 0 0'>"
    "          <joint name='tilt' axis='0 1 0'/><geom type='box' size='0.03 0.025 0.002' mass='0.2'/>"
    "        </body></body></body>"
    "  </worldbody>"
    "  <actuator>"
    "    <position joint='lift' kp='400'/><position joint='bend' kp='300'/><position joint='tilt' kp='60'/>"
    "  </actuator>"
    "</mujoco>";

static const double soil_at_m[3] = {0.45, 0, 0};

static int failed(const char *what) {
  hapto_error error = {sizeof error, 0, "", "", "", ""};
  hapto_last_error(&error);
  fprintf(stderr, "%s: %s\n", what, error.message);
  return 1;
}

/* Joint angles that put the blade, level, at (x, z); two links of 0.3 and 0.25 m, elbow up. */
static void reach(double x, double z, double angles[3]) {
  const double a = 0.3, b = 0.25, dz = z - 0.25, r2 = x * x + dz * dz;
  const double inner = acos(fmax(-1, fmin(1, (r2 - a * a - b * b) / (2 * a * b))));
  angles[1] = inner; /* about y; positive rotates the link down */
  angles[0] = -atan2(dz, x) - atan2(b * sin(inner), a + b * cos(inner));
  angles[2] = -angles[0] - angles[1];
}

/* Target of the blade: down into the soil, along it, and up again. */
static void wanted(double t, double surface_m, double *x, double *z) {
  const double down = fmin(t, 1), along = fmin(fmax(t - 1, 0), 2) / 2, up = fmin(fmax(t - 3, 0), 1);
  *x = soil_at_m[0] + 0.03 - 0.06 * along;
  *z = surface_m + 0.03 - 0.045 * down + 0.06 * up;
}

int main(int argc, char **argv) {
  /* The tool in the soil is a box with the size of the blade. */
  const char *overrides[] = {"soil.name=lunar-0-15cm", "bed.start=settled", "bed.depth_mm=40", "tool.shape=box", "tool.size_mm=[60, 50, 4]"};
  hapto_scene *scene = NULL;
  hapto_scene_info info = {sizeof info};
  if (hapto_scene_from_file("icra2021", overrides, 5, NULL, NULL, &scene) != HAPTO_OK) return failed("scene");
  if (hapto_scene_get_info(scene, &info) != HAPTO_OK) return failed("info");

  char why[500] = "";
  mjVFS *files = (mjVFS *)mju_malloc(sizeof(mjVFS));
  mj_defaultVFS(files);
  mj_makeEmptyFileVFS(files, "arm.xml", (int)strlen(arm));
  memcpy(files->filedata[mj_findFileVFS(files, "arm.xml")], arm, strlen(arm));
  mjModel *model = mj_loadXML("arm.xml", files, why, sizeof why);
  if (model == NULL) {
    fprintf(stderr, "MuJoCo: %s\n", why);
    return 1;
  }
  mjData *data = mj_makeData(model);
  const int blade = mj_name2id(model, mjOBJ_BODY, "blade");
  FILE *csv = argc > 1 ? fopen(argv[1], "wx") : NULL;
  if (csv != NULL) fprintf(csv, "t_s,x_m,z_m,wanted_x_m,wanted_z_m,force_x_n,force_z_n,lift_nm\n");

  double x, z, strongest_n = 0, lag_m = 0;
  wanted(0, info.surface_m, &x, &z);
  reach(x, z, data->qpos);
  mj_forward(model, data);
  for (int tick = 0; tick < 4200; ++tick) {
    wanted(data->time, info.surface_m, &x, &z);
    reach(x, z, data->ctrl);

    /* MuJoCo -> soil: pose and velocity of the blade in the soil's frame. */
    hapto_pose pose;
    hapto_twist twist;
    hapto_wrench felt;
    double velocity[6];
    mj_objectVelocity(model, data, mjOBJ_BODY, blade, velocity, 0); /* angular, then linear velocity, in world axes */
    for (int i = 0; i < 3; ++i) {
      pose.position_m[i] = data->xpos[3 * blade + i] - soil_at_m[i];
      twist.angular_rad_s[i] = velocity[i];
      twist.linear_m_s[i] = velocity[3 + i];
    }
    memcpy(pose.orientation, data->xquat + 4 * blade, sizeof pose.orientation);
    if (tick == 0) hapto_scene_place_tool(scene, &pose);
    if (hapto_scene_step(scene, &pose, &twist, &felt) != HAPTO_OK) return failed("step");

    /* Soil -> MuJoCo: xfrc_applied acts at the body's centre of mass, the soil's wrench about the blade's origin. */
    double *applied = data->xfrc_applied + 6 * blade, lever[3], moment[3];
    for (int i = 0; i < 3; ++i) lever[i] = data->xpos[3 * blade + i] - data->xipos[3 * blade + i];
    mju_cross(moment, lever, felt.force_n);
    for (int i = 0; i < 3; ++i) {
      applied[i] = felt.force_n[i];
      applied[3 + i] = felt.torque_nm[i] + moment[i];
    }
    mj_step(model, data);

    const double force_n = sqrt(felt.force_n[0] * felt.force_n[0] + felt.force_n[2] * felt.force_n[2]);
    strongest_n = fmax(strongest_n, force_n);
    lag_m = fmax(lag_m, fabs(data->xpos[3 * blade + 2] - z));
    if (csv != NULL && tick % 10 == 0)
      fprintf(csv, "%.3f,%.5f,%.5f,%.5f,%.5f,%.4f,%.4f,%.4f\n", data->time, data->xpos[3 * blade], data->xpos[3 * blade + 2], x, z,
              felt.force_n[0], felt.force_n[2], data->actuator_force[0]);
    if (tick % 600 == 0)
      printf("%3.1f s  blade %+6.1f mm above the soil  force %7.2f N back %7.2f N up\n", data->time,
             (data->xpos[3 * blade + 2] - info.surface_m) * 1e3, felt.force_n[0], felt.force_n[2]);
  }
  printf("strongest force %.1f N; the arm gave way by %.1f mm at most\n", strongest_n, lag_m * 1e3);
  if (csv != NULL) fclose(csv);
  mj_deleteData(data);
  mj_deleteModel(model);
  mj_deleteVFS(files);
  mju_free(files);
  hapto_scene_destroy(scene);
  return 0;
}
