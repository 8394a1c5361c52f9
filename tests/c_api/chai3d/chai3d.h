// Mocks of the classes of CHAI3D 3.3 that haptolith/chai3d.hpp uses: their names and behaviour, in few
// lines. With CHAI3D_DIR the same tests run with the real ones.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace chai3d {

// NOLINTBEGIN(readability-identifier-naming): these are CHAI3D's names
const double C_PI = 3.14159265358979323846;

class cVector3d {
 public:
  cVector3d() = default;
  cVector3d(double x, double y, double z) : v_{{x, y, z}} {}
  double& operator()(int i) { return v_[static_cast<std::size_t>(i)]; }
  const double& operator()(int i) const { return v_[static_cast<std::size_t>(i)]; }
  void zero() { v_ = {{0, 0, 0}}; }
  double length() const { return std::sqrt(v_[0] * v_[0] + v_[1] * v_[1] + v_[2] * v_[2]); }

 private:
  std::array<double, 3> v_{{0, 0, 0}};
};
inline cVector3d operator+(const cVector3d& a, const cVector3d& b) {
  return {a(0) + b(0), a(1) + b(1), a(2) + b(2)};
}
inline cVector3d operator-(const cVector3d& a, const cVector3d& b) {
  return {a(0) - b(0), a(1) - b(1), a(2) - b(2)};
}
inline cVector3d operator*(double scale, const cVector3d& v) {
  return {scale * v(0), scale * v(1), scale * v(2)};
}
inline cVector3d operator/(const cVector3d& v, double scale) {
  return {v(0) / scale, v(1) / scale, v(2) / scale};
}

class cMatrix3d {
 public:
  double& operator()(int i, int j) { return m_[3 * static_cast<std::size_t>(i) + static_cast<std::size_t>(j)]; }
  const double& operator()(int i, int j) const {
    return m_[3 * static_cast<std::size_t>(i) + static_cast<std::size_t>(j)];
  }
  void identity() { set(1, 0, 0, 0, 1, 0, 0, 0, 1); }
  void set(const double& m00, const double& m01, const double& m02, const double& m10, const double& m11,
           const double& m12, const double& m20, const double& m21, const double& m22) {
    m_ = {{m00, m01, m02, m10, m11, m12, m20, m21, m22}};
  }

 private:
  std::array<double, 9> m_{};
};
inline cVector3d operator*(const cMatrix3d& m, const cVector3d& v) {
  cVector3d out;
  for (int i = 0; i < 3; ++i) {
    out(i) = m(i, 0) * v(0) + m(i, 1) * v(1) + m(i, 2) * v(2);
  }
  return out;
}
inline cMatrix3d operator*(const cMatrix3d& a, const cMatrix3d& b) {
  cMatrix3d out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      out(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
    }
  }
  return out;
}
inline cMatrix3d cTranspose(const cMatrix3d& m) {
  cMatrix3d out;
  out.set(m(0, 0), m(1, 0), m(2, 0), m(0, 1), m(1, 1), m(2, 1), m(0, 2), m(1, 2), m(2, 2));
  return out;
}

struct cColorf {
  explicit cColorf(float r = 0, float g = 0, float b = 0, float a = 1) : rgba{{r, g, b, a}} {}
  std::array<float, 4> rgba;
};
struct cRenderOptions {};

/// Deletes its children, without notifying any observer of its end.
class cGenericObject {
 public:
  cGenericObject() {
    m_localRot.identity();
    m_globalRot.identity();
  }
  virtual ~cGenericObject() {
    for (cGenericObject* child : m_children) {
      delete child;
    }
  }
  cGenericObject(const cGenericObject&) = delete;
  cGenericObject& operator=(const cGenericObject&) = delete;

  virtual std::string getClassName() { return "GenericObject"; }
  virtual void setLocalPos(const cVector3d& a_localPos) { m_localPos = a_localPos; }
  void setLocalPos(double x = 0, double y = 0, double z = 0) { setLocalPos(cVector3d(x, y, z)); }
  virtual void setLocalRot(const cMatrix3d& a_localRot) { m_localRot = a_localRot; }
  cVector3d getGlobalPos() const { return m_globalPos; }
  cMatrix3d getGlobalRot() const { return m_globalRot; }
  bool addChild(cGenericObject* a_object) {
    m_children.push_back(a_object);
    return true;
  }
  bool removeChild(cGenericObject* a_object) {
    for (std::size_t i = 0; i < m_children.size(); ++i) {
      if (m_children[i] == a_object) {
        m_children.erase(m_children.begin() + static_cast<std::ptrdiff_t>(i));
        return true;
      }
    }
    return false;
  }
  virtual void computeGlobalPositions(const bool a_frameOnly = true, const cVector3d& a_globalPos = cVector3d(0, 0, 0),
                                      const cMatrix3d& a_globalRot = unturned()) {
    m_globalPos = a_globalPos + a_globalRot * m_localPos;
    m_globalRot = a_globalRot * m_localRot;
    updateGlobalPositions(a_frameOnly);
    for (cGenericObject* child : m_children) {
      child->computeGlobalPositions(a_frameOnly, m_globalPos, m_globalRot);
    }
  }
  virtual void renderSceneGraph(cRenderOptions& a_options) {
    render(a_options);
    for (cGenericObject* child : m_children) {
      child->renderSceneGraph(a_options);
    }
  }

 protected:
  virtual void render(cRenderOptions& /*a_options*/) {}
  virtual void updateGlobalPositions(const bool /*a_frameOnly*/) {}
  static cMatrix3d unturned() {
    cMatrix3d m;
    m.identity();
    return m;
  }

  std::vector<cGenericObject*> m_children;
  cVector3d m_localPos, m_globalPos;
  cMatrix3d m_localRot, m_globalRot;
};
class cMesh : public cGenericObject {};
class cWorld : public cGenericObject {};

class cVertexArray {
 public:
  void setLocalPos(unsigned int i, const double& x, const double& y, const double& z) {
    m_localPos[i] = cVector3d(x, y, z);
  }
  cVector3d getLocalPos(unsigned int i) const { return m_localPos[i]; }
  std::vector<cVector3d> m_localPos;
};
class cMultiPoint : public cGenericObject {
 public:
  unsigned int newPoint(const cVector3d& a_vertex0, const cColorf& /*a_color*/) {
    m_vertices->m_localPos.push_back(a_vertex0);
    return getNumPoints() - 1;
  }
  unsigned int getNumPoints() { return static_cast<unsigned int>(m_vertices->m_localPos.size()); }
  void setPointSize(double /*a_pointSize*/) {}
  std::shared_ptr<cVertexArray> m_vertices = std::make_shared<cVertexArray>();
};

struct cHapticDeviceInfo {
  double m_maxLinearForce = 0.1, m_maxAngularTorque = 0.1, m_maxGripperForce = 0.1;
  double m_maxLinearStiffness = 0.1, m_maxAngularStiffness = 0.1;
  double m_workspaceRadius = 0.1, m_gripperMaxAngleRad = 0;
  bool m_sensedRotation = false, m_sensedGripper = false;
  bool m_actuatedPosition = false, m_actuatedRotation = false, m_actuatedGripper = false;
};
class cGenericHapticDevice {
 public:
  virtual ~cGenericHapticDevice() = default;
  virtual bool open() { return false; }
  virtual bool close() { return false; }
  virtual bool calibrate(bool /*a_forceCalibration*/ = false) { return false; }
  virtual bool getPosition(cVector3d& a_position) {
    a_position.zero();
    return false;
  }
  virtual bool getLinearVelocity(cVector3d& a_linearVelocity) {
    a_linearVelocity.zero();
    return false;
  }
  virtual bool getRotation(cMatrix3d& a_rotation) {
    a_rotation.identity();
    return false;
  }
  virtual bool getAngularVelocity(cVector3d& a_angularVelocity) {
    a_angularVelocity.zero();
    return false;
  }
  virtual bool getGripperAngleRad(double& a_angle) {
    a_angle = 0;
    return false;
  }
  virtual bool getUserSwitches(unsigned int& a_userSwitches) {
    a_userSwitches = 0;
    return false;
  }
  virtual bool setForceAndTorqueAndGripperForce(const cVector3d& /*a_force*/, const cVector3d& /*a_torque*/,
                                                double /*a_gripperForce*/) {
    return false;
  }
  cHapticDeviceInfo m_specifications;
};
using cGenericHapticDevicePtr = std::shared_ptr<cGenericHapticDevice>;

/// Scales positions and velocities of the device, and neither turns nor forces.
class cGenericTool : public cGenericObject {
 public:
  explicit cGenericTool(cWorld* /*a_parentWorld*/) : m_image(new cMesh) {
    m_deviceLocalRot.identity();
    m_deviceGlobalRot.identity();
  }
  ~cGenericTool() override { delete m_image; }
  cGenericTool(const cGenericTool&) = delete;
  cGenericTool& operator=(const cGenericTool&) = delete;

  void setHapticDevice(cGenericHapticDevicePtr a_hapticDevice) { m_hapticDevice = std::move(a_hapticDevice); }
  virtual bool start() {
    m_enabled = m_hapticDevice != nullptr && m_hapticDevice->open();
    updateFromDevice();
    return m_enabled;
  }
  virtual bool stop() { return m_enabled && m_hapticDevice->close(); }
  virtual void updateFromDevice() {
    if (!m_enabled) {
      return;
    }
    cVector3d position, velocity, turning;
    cMatrix3d rotation;
    rotation.identity();
    m_hapticDevice->getPosition(position);
    m_hapticDevice->getRotation(rotation);
    m_hapticDevice->getLinearVelocity(velocity);
    m_hapticDevice->getAngularVelocity(turning);
    m_hapticDevice->getGripperAngleRad(m_gripperAngle);
    m_hapticDevice->getUserSwitches(m_userSwitches);
    m_deviceLocalPos = m_workspaceScaleFactor * position;
    m_deviceGlobalPos = m_globalPos + m_globalRot * m_deviceLocalPos;
    m_deviceLocalRot = rotation;
    m_deviceGlobalRot = m_globalRot * rotation;
    m_deviceLocalLinVel = m_workspaceScaleFactor * velocity;
    m_deviceGlobalLinVel = m_globalRot * m_deviceLocalLinVel;
    m_deviceLocalAngVel = turning;
    m_deviceGlobalAngVel = m_globalRot * turning;
  }
  virtual void computeInteractionForces() {}
  virtual bool applyToDevice() {
    if (!m_enabled) {
      return false;
    }
    const cVector3d zero;
    return m_hapticDevice->setForceAndTorqueAndGripperForce(
        m_forceOn ? m_deviceLocalForce : zero, m_forceOn ? m_deviceLocalTorque : zero, m_forceOn ? m_gripperForce : 0);
  }
  virtual bool setForcesON() { return m_forceOn = true; }
  virtual bool setForcesOFF() {
    m_forceOn = false;
    return applyToDevice();
  }
  void setUseForceRise(const bool a_value) { m_useForceRise = a_value; }
  bool getUseForceRise() { return m_useForceRise; }
  bool setWorkspaceScaleFactor(const double& a_factor) {
    m_workspaceScaleFactor = a_factor;
    return true;
  }
  virtual cVector3d getDeviceLocalForce() const { return m_deviceLocalForce; }
  virtual cVector3d getDeviceLocalTorque() const { return m_deviceLocalTorque; }
  virtual cVector3d getDeviceGlobalForce() const { return m_deviceGlobalForce; }
  virtual double getGripperForce() const { return m_gripperForce; }
  virtual void setDeviceLocalForce(const cVector3d& a_force) {
    m_deviceLocalForce = a_force;
    m_deviceGlobalForce = m_globalRot * a_force;
  }
  virtual void setDeviceLocalTorque(const cVector3d& a_torque) { m_deviceLocalTorque = a_torque; }
  virtual void setGripperForce(const double& a_force) { m_gripperForce = a_force; }
  void render(cRenderOptions& /*a_options*/) override {}

  cGenericObject* m_image;

 protected:
  cGenericHapticDevicePtr m_hapticDevice;
  bool m_enabled = false, m_forceOn = true, m_useForceRise = true;
  unsigned int m_userSwitches = 0;
  double m_workspaceScaleFactor = 1, m_gripperAngle = 0, m_gripperForce = 0;
  cVector3d m_deviceLocalForce, m_deviceGlobalForce, m_deviceLocalTorque;
  cVector3d m_deviceLocalPos, m_deviceGlobalPos, m_deviceLocalLinVel, m_deviceGlobalLinVel, m_deviceLocalAngVel,
      m_deviceGlobalAngVel;
  cMatrix3d m_deviceLocalRot, m_deviceGlobalRot;
};
// NOLINTEND(readability-identifier-naming)

}  // namespace chai3d
