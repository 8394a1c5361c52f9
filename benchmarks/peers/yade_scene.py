# Scene of peer_scene.cpp in Yade (https://yade-dem.org): yade -n -x yade_scene.py <scene.json> <curve.txt>
#
# Spheres without rotation, a linear spring and damper along the line of centres, Cundall and Strack's spring, damper and
# slider across it. Positions, radii, masses, velocities, movement and the plate's servo come from the scene. The curve
# has the rows of haptolith's.

import json
import math
import sys
import time

from yade import (Bo1_Sphere_Aabb, ForceResetter, Ig2_Sphere_Sphere_ScGeom, InsertionSortCollider, InteractionLoop,
                  Ip2_ViscElMat_ViscElMat_ViscElPhys, Law2_ScGeom_ViscElPhys_Basic, NewtonIntegrator, O, PyRunner,
                  TranslationEngine, Vector3, ViscElMat, utils)

scene_path, curve_path = sys.argv[-2:]
with open(scene_path) as file:
    scene = json.load(file)
dt = scene['dt_s']

# Springs and dampers of two bodies are in series, so each gets twice the value of the contact. (The documentation of
# 2023.02a has 2 a b / (a + b); the code has a b / (a + b), which check_contact() verifies.)
material = O.materials.append(
    ViscElMat(density=1000, frictionAngle=math.atan(scene['mu']), kn=2 * scene['k_n_m'],
              ks=2 * scene['k_t_n_m'], cn=2 * scene['c_n_s_m'], cs=2 * scene['c_t_n_s_m']))

# Soil is in contact with soil and bodies; bodies are not in contact with each other.
SOIL, BODY = 1, 2

O.periodic = True
height = 10.0
O.cell.setBox(scene['width_m'], scene['length_m'], height)
last_body = max(p[7] for p in scene['particles'])
driven = []
soil = []
for x, y, z, radius, vx, vy, vz, body in scene['particles']:
    if body < 0 and z < scene['spilled_below_m']:
        continue
    # The cell begins at the origin; only relative positions matter.
    sphere = utils.sphere((x + scene['width_m'] / 2, y + scene['length_m'] / 2, z), radius, material=material)
    sphere.mask = SOIL if body < 0 else SOIL | BODY
    sphere.state.blockedDOFs = 'XYZ' if body < 0 else 'xyzXYZ'
    sphere.state.mass = scene['mass_kg']
    sphere.state.vel = (vx, vy, vz)
    number = O.bodies.append(sphere)
    if body < 0:
        soil.append(number)
    elif body == last_body:
        driven.append(number)


def speed_at(now):
    movement = scene['movement']
    for (t0, v0), (t1, v1) in zip(movement, movement[1:]):
        if now < t1:
            return v0 + (v1 - v0) * (now - t0) / (t1 - t0)
    return movement[-1][1]


class Driver:
    """Movement of the driven body, and output: before each step, with the forces of the previous step."""

    def __init__(self):
        self.step = 0
        self.sinking = 0.0
        self.displacement = 0.0
        self.sum = Vector3(0, 0, 0)
        self.curve = open(curve_path, 'w')
        self.curve.write('# time_s displacement_m height_m force_x_n force_y_n force_z_n area_m2 x_m y_m z_m\n')

    def before_step(self):
        force = Vector3(0, 0, 0)
        if self.step > 0:
            for axis in range(3):
                unit = Vector3(0, 0, 0)
                unit[axis] = 1
                force[axis] = utils.sumForces(driven, unit)
            self.note(force)
        servo = scene.get('servo')
        if servo:
            push = force[2] - servo['load_n'] - servo['damping_n_s_m'] * self.sinking
            self.sinking += dt / servo['mass_kg'] * push
            self.sinking = min(max(self.sinking, -servo['fastest_m_s']), servo['fastest_m_s'])
        along = speed_at(self.step * dt)
        velocity = Vector3(along, 0, self.sinking)
        mover.velocity = velocity.norm()
        mover.translationAxis = velocity.normalized() if mover.velocity > 0 else Vector3(1, 0, 0)
        self.displacement += dt * along
        self.step += 1

    def note(self, force):
        self.sum += force
        rows = scene['steps_per_row']
        if self.step % rows == 0:
            mean = self.sum / rows
            self.sum = Vector3(0, 0, 0)
            level = sum(O.bodies[i].state.pos[2] for i in driven) / len(driven)
            first = O.bodies[soil[0]].state.pos
            numbers = (self.step * dt, self.displacement, level, mean[0], mean[1], mean[2],
                       scene['width_m'] * scene['length_m'], first[0] - scene['width_m'] / 2,
                       first[1] - scene['length_m'] / 2, first[2])
            self.curve.write(' '.join('%.9g' % number for number in numbers) + '\n')


def check_contact():
    """Checks that the constants of a contact in Yade are those of the scene."""
    for contact in O.interactions:
        if contact.isReal:
            phys = contact.phys
            for mine, wanted in ((phys.kn, 'k_n_m'), (phys.ks, 'k_t_n_m'), (phys.cn, 'c_n_s_m'), (phys.cs, 'c_t_n_s_m'),
                                 (phys.tangensOfFrictionAngle, 'mu')):
                if abs(mine - scene[wanted]) > 1e-9 * abs(scene[wanted]):
                    sys.exit('yade_scene.py: a contact has %s = %g instead of %g' % (wanted, mine, scene[wanted]))
            return


def stop_spilled():
    """Stops the soil that has fallen off the tray: a periodic cell has no floor, so it would re-enter from above."""
    for number in soil:
        state = O.bodies[number].state
        if state.pos[2] < scene['spilled_below_m']:
            state.blockedDOFs = 'xyzXYZ'
            state.vel = (0, 0, 0)


driver = Driver()
mover = TranslationEngine(ids=driven, velocity=0, translationAxis=(1, 0, 0))
O.engines = [
    PyRunner(command='driver.before_step()', iterPeriod=1, initRun=True),
    mover,
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()], avoidSelfInteractionMask=BODY),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [Ip2_ViscElMat_ViscElMat_ViscElPhys()],
                    [Law2_ScGeom_ViscElPhys_Basic()]),
    NewtonIntegrator(damping=0, gravity=(0, 0, -scene['gravity_m_s2'])),
    PyRunner(command='stop_spilled()', iterPeriod=200),
]
O.dt = dt
started = time.time()
O.run(scene['steps'] // 2, True)
check_contact()
O.run(scene['steps'] + 1 - O.iter, True)  # one step more, at whose beginning the last is recorded
driver.curve.close()
print('%d steps of %d particles in %.0f s' % (scene['steps'], len(O.bodies), time.time() - started))
