// Soil in a CHAI3D application: a bed, a tool, and CHAI3D's loop around them. A simulated handle presses into the soil, so that
// this runs without a device or a window; a real one is from chai3d::cHapticDeviceHandler.
#include <cstdio>
#include <haptolith/chai3d.hpp>

class PressingHandle : public chai3d::cGenericHapticDevice {
 public:
  PressingHandle() {
    m_specifications.m_maxLinearForce = 12;
    m_specifications.m_maxLinearStiffness = 4000;
    m_specifications.m_workspaceRadius = 0.075;
    m_specifications.m_actuatedPosition = true;
  }
  bool open() override { return true; }
  bool close() override { return true; }
  bool getPosition(chai3d::cVector3d &a_position) override {
    a_position = chai3d::cVector3d(0, 0, height_m);
    return true;
  }
  bool getLinearVelocity(chai3d::cVector3d &a_linearVelocity) override {
    a_linearVelocity = chai3d::cVector3d(0, 0, velocity_m_s);
    return true;
  }
  double height_m = 0, velocity_m_s = -0.011;
};

int main() {
  hapto_scene *scene = nullptr;
  const char *overrides[] = {"soil.preset=P3", "gravity.body=Moon"};
  if (hapto_scene_from_file("icra2021", overrides, 2, nullptr, nullptr, &scene) != HAPTO_OK) {
    std::fprintf(stderr, "no scene\n");
    return 1;
  }
  chai3d::cWorld *world = new chai3d::cWorld;
  hapto::cHaptolithBed *bed = new hapto::cHaptolithBed(scene);
  bed->setLocalPos(0, 0, -bed->getSurfaceHeight() - 0.02);  // the surface is 2 cm below the workspace's centre
  world->addChild(bed);

  hapto::cHaptolithTool *tool = new hapto::cHaptolithTool(world, *bed);
  std::shared_ptr<PressingHandle> handle = std::make_shared<PressingHandle>();
  tool->setHapticDevice(handle);
  world->addChild(tool);
  world->computeGlobalPositions(true);
  tool->start();

  for (int tick = 0; tick <= 2500; ++tick) {  // 2.5 s; the soft start ends at 2 s
    handle->height_m = handle->velocity_m_s * tick * 1e-3;
    world->computeGlobalPositions(true);
    tool->updateFromDevice();
    tool->advance(1e-3);  // simulated time; with a real device, computeInteractionForces() uses the clock
    tool->applyToDevice();
    if (tick % 500 == 0) {
      std::printf("%.1f s feels %6.3f N\n", tick / 1000.0, tool->getDeviceGlobalForce()(2));
    }
  }
  tool->stop();
  delete world;  // also deletes bed and tool
  hapto_scene_destroy(scene);
  return 0;
}
