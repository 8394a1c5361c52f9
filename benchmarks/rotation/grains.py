"""Grains that turn or do not, and what they stand in: written down as LAMMPS reads it."""

import math
import pathlib
import random
import re
import subprocess
import sys
import time
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
EARTH, MOON = 9.807, 1.625  # m/s^2
# Spheres fill 0.64 at most, so this mass at 7 mm makes a bed as heavy as dry sand (soils/dry-sand.toml: 1317 kg/m^3).
# That soil gets there with less, for its contacts begin softly (a hyperbola) and let grains come closer; LAMMPS has
# nothing but a straight line.
RHO0_KG_M3 = 1560
SOIL, BODY, TOOL = 1, 2, 3  # types of atoms
TOOL_FRICTION = 0.36  # as in `haptolith lab blade`


class Grain:
    """What happens where two grains touch. `rolling`: the largest moment over R N; None: grains do not turn."""

    def __init__(self, name, friction, rolling):
        self.name, self.friction, self.rolling = name, friction, rolling

    @property
    def turns(self):
        return self.rolling is not None


class Soil:
    def __init__(self, radius_mm=None):
        path = ROOT / 'soils/dry-sand.toml'
        with open(path, 'rb') as file:
            soil = tomllib.load(file)['soil']
        self.radius = soil['radius_mm'] / 1e3
        scale = 1 if radius_mm is None else radius_mm / soil['radius_mm']
        self.radius *= scale
        self.k = soil['stiffness_n_m'] * scale
        self.k_t = soil['tangential_ratio'] * self.k
        self.spread = soil['size_spread']
        self.friction = soil['contact_friction']
        self.mass = 4 * math.sqrt(2) * RHO0_KG_M3 * self.radius ** 3
        self.damper = soil['damping_ratio'] * math.sqrt(2 * self.mass * self.k)
        self.damper_t = soil['damping_ratio'] * math.sqrt(2 * self.mass * self.k_t)
        # 5 steps in sqrt(m / k) are as long as haptolith's at this damping, for grains that turn too: check_step().
        self.dt = 0.2 * math.sqrt(self.mass / self.k)

    @property
    def d(self):
        return 2 * self.radius

    def number_in(self, volume):
        """Grains that fill a volume when they are packed densely."""
        return int(0.64 * volume / (4 / 3 * math.pi * self.radius ** 3))

    def contact(self, grain, friction=None, stiffer=1):
        friction = grain.friction if friction is None else friction
        law = 'hooke %g %g damping velocity tangential linear_history %g %g %g' % (
            stiffer * self.k, self.damper, stiffer * self.k_t, self.damper_t / self.damper, friction)
        if grain.rolling and friction > 0:
            # LAMMPS: moment <= mu_roll N r1 r2 / (r1 + r2), which is R / 2 among equals.
            law += ' rolling sds %g %g %g' % (self.k_t, self.damper_t, 2 * grain.rolling)
        return law + ' limit_damping'


class Box:
    """x and y from -half to half, z from bottom to top; a side is periodic, a wall or open."""

    def __init__(self, x, y, bottom, top, periodic=''):
        self.x, self.y, self.bottom, self.top, self.periodic = x, y, bottom, top, periodic

    def boundary(self):
        return ' '.join('p' if axis in self.periodic else 'f' for axis in 'xyz')


def loose(soil, box, number, bottom, rng, inside=lambda x, y, z: True, poured=False):
    """Grains on a grid so wide that none touch, as haptolith's looseSoil(): [x, y, z, radius, type]. To be poured, every
    other storey stands over the gaps of the one below."""
    largest = soil.radius * (1 + soil.spread)
    cell = (2.6 if poured else 2.15) * largest
    play = cell / 2 - largest
    columns, rows = max(1, int(box.x / cell)), max(1, int(box.y / cell))
    grains, storey = [], 0
    while len(grains) < number:
        gaps = storey % 2 if poured else 0
        first = 0.5 + 0.5 * gaps
        for row in range(rows - gaps):
            for column in range(columns - gaps):
                at = ((column + first) * box.x / columns - box.x / 2 + play * rng.uniform(-1, 1),
                      (row + first) * box.y / rows - box.y / 2 + play * rng.uniform(-1, 1),
                      bottom + (storey + 0.5) * cell + play * rng.uniform(-1, 1))
                if inside(*at) and len(grains) < number:
                    grains.append([*at, soil.radius * (1 + soil.spread * rng.uniform(-1, 1)), SOIL])
        storey += 1
    return grains


def rough_plate(soil, box, height, rng, kind=BODY):
    """Closer together than grains are wide, at random heights of +-0.6 R, as haptolith's roughPlate()."""
    columns, rows = (math.ceil(side / (1.6 * soil.radius)) for side in (box.x, box.y))
    return [[(column + 0.5) / columns * box.x - box.x / 2, (row + 0.5) / rows * box.y - box.y / 2,
             height + 0.6 * soil.radius * rng.uniform(-1, 1), soil.radius * (1 + soil.spread * rng.uniform(-1, 1)), kind]
            for row in range(rows) for column in range(columns)]


def write_data(path, soil, box, grains, mass_of=None):
    with open(path, 'w') as file:
        file.write('grains\n\n%d atoms\n%d atom types\n' % (len(grains), TOOL))
        for axis, low, high in (('x', -box.x / 2, box.x / 2), ('y', -box.y / 2, box.y / 2), ('z', box.bottom, box.top)):
            file.write('%.9g %.9g %slo %shi\n' % (low, high, axis, axis))
        file.write('\nAtoms # sphere\n\n')
        for number, (x, y, z, radius, kind) in enumerate(grains, 1):
            mass = (mass_of or {}).get(kind, soil.mass)
            density = mass / (4 / 3 * math.pi * radius ** 3)
            file.write('%d %d %.9g %.9g %.9g %.9g %.9g\n' % (number, kind, 2 * radius, density, x, y, z))


def read_dump(path):
    """Of `dump custom id type radius x y z`."""
    with open(path) as file:
        lines = file.read().split('\n')
    start = max(i for i, line in enumerate(lines) if line.startswith('ITEM: ATOMS'))
    rows = sorted([float(word) for word in line.split()] for line in lines[start + 1:] if line)
    return [[x, y, z, radius, int(kind)] for _, kind, radius, x, y, z in rows]


def head(soil, box, grain, data, gravity):
    """Everything up to who moves. The bodies' grains do not meet each other."""
    tool = soil.contact(grain, friction=min(TOOL_FRICTION, 1e9 * grain.friction), stiffer=2)
    return '\n'.join([
        'units si', 'atom_style sphere', 'boundary ' + box.boundary(), 'newton off', 'comm_modify vel yes',
        'read_data %s' % data, 'neighbor %g bin' % (0.35 * soil.radius), 'neigh_modify delay 0 every 1 check yes',
        'group soil type %d' % SOIL, 'group bodies type %d %d' % (BODY, TOOL), 'neigh_modify exclude group bodies bodies',
        'pair_style granular', 'pair_coeff * * ' + soil.contact(grain),
        'pair_coeff %d %d %s' % (SOIL, TOOL, tool),
        'fix gravity soil gravity %g vector 0 0 -1' % gravity if gravity > 0 else '',
        'fix turn soil %s' % ('nve/sphere' if grain.turns else 'nve'),  # nve leaves omega at 0: no grain turns
        'timestep %g' % soil.dt,
        'compute vx soil property/atom vx', 'variable speed atom sqrt(vx*vx+vy*vy+vz*vz)',
        'compute fastest soil reduce max v_speed', ''])


def side_walls(soil, box, grain):
    """Smooth, as haptolith's side walls."""
    return '\n'.join('fix wall_%s soil wall/gran granular %s %splane %g %g' % (
        axis, soil.contact(grain, friction=0), axis, -side / 2, side / 2)
        for axis, side in (('x', box.x), ('y', box.y)) if axis not in box.periodic) + '\n'


def lammps(folder, name, text):
    """Runs an input; returns what LAMMPS said. Its files are relative to the folder."""
    (folder / (name + '.in')).write_text(text)
    started = time.time()
    said = subprocess.run(['lmp', '-in', name + '.in', '-log', 'none'], cwd=folder, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, env={'OMP_NUM_THREADS': '1', 'PATH': '/usr/bin:/bin'})
    (folder / (name + '.said')).write_text(said.stdout)
    if said.returncode != 0 or 'ERROR' in said.stdout:
        sys.exit('run: lmp failed, see %s:\n%s' % (folder / (name + '.said'), said.stdout[-1500:]))
    print('    %s: %.0f s' % (name, time.time() - started), file=sys.stderr, flush=True)
    return said.stdout


def thermo(said, first_column='Time'):
    """All rows of thermo tables, each a dictionary."""
    rows, names = [], None
    for line in said.split('\n'):
        words = line.split()
        if words and words[0] == first_column:
            names = words
        elif names and words and len(words) == len(names) and re.match(r'^[-+.\deinfa]+$', words[0]):
            rows.append({name: float(word) for name, word in zip(names, words)})
        elif names and line.startswith('Loop time'):
            names = None
    return rows


def settle(folder, name, soil, box, grains, gravity, extra, falls_as=Grain('smooth', 0, None)):
    """Falls until it rests; the grains afterwards. Without friction, as haptolith's dense specimens, unless `falls_as` has
    some. Kept, for grains of all kinds begin from it."""
    dump = folder / (name + '.settled')
    if not dump.exists():
        write_data(folder / (name + '.loose'), soil, box, grains)
        slow = soil.mass * math.sqrt(gravity / soil.d) * 0.4  # viscosity: nothing falls fast
        steps = max(500, round(0.1 / soil.dt))
        # Six times what haptolith asks for: friction, which comes next, ends the rest, and each test looks whether it has.
        at_rest = 6 * math.sqrt(2 * gravity * soil.radius / 500)
        text = head(soil, box, falls_as, name + '.loose', gravity) + side_walls(soil, box, falls_as) + extra(falls_as) + '\n'.join([
            'fix slow soil viscous %g' % slow, 'thermo_style custom time atoms ke c_fastest', 'thermo_modify lost ignore', 'thermo %d' % steps,
            'run %d' % (5 * steps), 'variable i loop 100', 'label again', 'run %d' % steps,
            'variable v equal c_fastest', 'if "${v} < %g" then "jump SELF done"' % at_rest,
            'next i', 'jump SELF again', 'label done',
            'write_dump all custom %s.settled id type radius x y z modify sort id format float %%.9g' % name, ''])
        rows = thermo(lammps(folder, name + '-settle', text))
        if rows[-1]['c_fastest'] >= at_rest:
            sys.exit('run: %s does not come to rest: %g m/s' % (name, rows[-1]['c_fastest']))
        if rows[-1]['Atoms'] != len(grains):
            sys.exit('run: %s lost grains while it settled' % name)
    return read_dump(dump)


def rng_of(name, seed):
    return random.Random('%s %d' % (name, seed))
