"""The laboratory's tests for grains in LAMMPS. Each returns a dictionary of what it measured."""

import math
import statistics
import sys

from grains import (BODY, EARTH, SOIL, TOOL, Box, Soil, lammps, head, loose, read_dump, rng_of, rough_plate, settle,
                    side_walls, thermo, write_data)

SHEAR_STRESSES_PA = (1000, 3000)
INERTIAL_NUMBER = 0.02  # at the smallest stress
RESIDUAL_FROM, STRAIN = 2, 3.6
BEVERLOO_C, BEVERLOO_K = 0.58, 1.4  # as src/haptolith/lab/theory/beverloo.h


def read_columns(path):
    with open(path) as file:
        return [[float(word) for word in line.split()] for line in file if not line.startswith('#')]


def shear(folder, grain, seed, stresses=SHEAR_STRESSES_PA):
    """A loaded rough plate drawn over a dense specimen, periodic on four sides, without gravity."""
    soil = Soil()
    d = soil.d
    points = []
    for stress in stresses:
        name = 'shear-%g-%d' % (stress, seed)
        rng = rng_of(name, seed)
        box = Box(14 * d, 10 * d, -2 * d, 40 * d, 'xy')
        grains = rough_plate(soil, box, 0, rng)
        grains += loose(soil, box, soil.number_in(box.x * box.y * 10 * d), 2 * soil.radius, rng)
        grains = settle(folder, name, soil, box, grains, EARTH,
                        lambda g: '')
        top = max(z for _, _, z, _, kind in grains if kind == SOIL)
        grains += rough_plate(soil, box, top + 2.2 * soil.radius, rng, TOOL)
        plate = sum(1 for g in grains if g[4] == TOOL)
        area = box.x * box.y
        plate_mass = soil.mass * area / d ** 2
        damping = math.sqrt(plate_mass * soil.k * area) / d * 0.1
        this = '%s-%s' % (name, grain.name)
        write_data(folder / (this + '.data'), soil, box, grains, {TOOL: plate_mass / plate})
        # Grains of the upper plate are of the tool's type, but soil to what touches them.
        text = head(soil, box, grain, this + '.data', 0) + '\n'.join([
            'pair_coeff %d %d %s' % (SOIL, TOOL, soil.contact(grain)),
            'group upper type %d' % TOOL, 'variable height equal xcm(upper,z)',
            'fix top upper setforce 0 0 NULL',
            'variable push equal -(%g+%g*vcm(upper,z))/%d' % (stress * area, damping, plate),
            'fix load upper aveforce NULL NULL v_push', 'fix rise upper nve',
            'thermo_style custom time atoms ke c_fastest v_height f_top[1] f_top[3]', 'thermo_modify lost ignore', 'thermo 1000', ''])
        load_steps = round(0.6 / soil.dt)
        density = 1317
        speed = INERTIAL_NUMBER * 10 * math.sqrt(min(stresses) / density)  # strain 1 is 10 d
        height = 10 * d
        steps = round(STRAIN * height / speed / soil.dt)
        text += '\n'.join([
            'run %d' % load_steps, 'velocity upper set %g NULL NULL' % speed,
            'fix curve all ave/time 1 20 20 f_top[1] f_top[3] v_height file %s.curve' % this, 'run %d' % steps, ''])
        rows = thermo(lammps(folder, this, text))
        curve = read_columns(folder / (this + '.curve'))
        strain_per_row = 20 * soil.dt * speed / height
        shears = [-row[1] / area for row in curve]
        normals = [row[2] / area for row in curve]
        begin = round(RESIDUAL_FROM / strain_per_row)
        window = round(0.05 / strain_per_row)
        halves = [statistics.mean(shears[begin:(begin + len(shears)) // 2]), statistics.mean(shears[(begin + len(shears)) // 2:])]
        soil_mass = soil.mass * sum(1 for g in grains if g[4] == SOIL)
        points.append(dict(
            normal_pa=statistics.mean(normals[begin:]), residual_pa=statistics.mean(shears[begin:]), halves_pa=halves,
            peak_pa=max(statistics.mean(shears[i:i + window]) for i in range(0, begin, 5)),
            density_kg_m3=soil_mass / area / (curve[0][3] - d), dilation=statistics.mean(r[3] for r in curve[begin:]) / curve[0][3] - 1,
            carried_pa=rows[-1]['f_top[3]'] / area, fastest_m_s=max(row['c_fastest'] for row in rows[1:])))
        if abs(points[-1]['normal_pa'] / stress - 1) > 0.05:
            sys.exit('run: %s does not carry its plate: %g Pa' % (this, points[-1]['normal_pa']))

    def angle(key):
        return math.degrees(math.atan(sum(p['normal_pa'] * p[key] for p in points) / sum(p['normal_pa'] ** 2 for p in points)))

    return dict(residual_deg=angle('residual_pa'), peak_deg=angle('peak_pa'), points=points)


def beverloo(soil, opening_m, density):
    return BEVERLOO_C * density * math.sqrt(EARTH) * (opening_m - BEVERLOO_K * soil.d) ** 2.5


def funnel(folder, grain, seed, opening, poured=False):
    """Discharge through a round opening in a flat rough floor; opening in d. As haptolith's funnelTest(); poured: with
    friction while the bed falls, so that it is looser."""
    soil = Soil()
    d, r = soil.d, soil.radius
    side = (opening + 8) * d
    fill = max(18, 3 * opening) * d
    box = Box(side, side, -8 * r, (4.5 if poured else 3.2) * fill + 20 * d)
    name = 'poured-%g-%d-bed-%s' % (opening, seed, grain.name) if poured else 'funnel-%g-%d' % (opening, seed)
    rng = rng_of(name, seed)
    ring_m = opening * d / 2 + r
    around = math.ceil(2 * math.pi * ring_m / (1.2 * r))
    floor = [[ring_m * math.cos(2 * math.pi * i / around), ring_m * math.sin(2 * math.pi * i / around), 0, r, BODY]
             for i in range(around)]
    for g in rough_plate(soil, box, 0, rng):
        from_axis = math.hypot(g[0], g[1])
        if from_axis > ring_m + 0.2 * r:
            floor.append(g)
        elif from_axis < ring_m - 0.2 * r:
            floor.append(g[:4] + [TOOL])  # the plug
    grains = floor + loose(soil, box, soil.number_in(side * side * fill), 2.6 * r, rng, poured=poured)
    grains = settle(folder, name, soil, box, grains, EARTH, lambda g: '', *([grain] if poured else []))
    soil_z = sorted(g[2] for g in grains if g[4] == SOIL)
    low, high = 2 * d, soil_z[-1] - 3 * d
    density = soil.mass * sum(1 for z in soil_z if low <= z < high) / (side * side * (high - low))
    this = '%s-%s' % (name, grain.name)
    write_data(folder / (this + '.data'), soil, box, grains)
    unit = math.sqrt(d / EARTH)
    look = max(1, round(0.5 * unit / soil.dt))
    middle = max(opening * d / 4, 2 * r)
    rest = round(0.4 / soil.dt)
    text = head(soil, box, grain, this + '.data', EARTH) + side_walls(soil, box, grain) + '\n'.join([
        'pair_coeff %d %d %s' % (SOIL, TOOL, soil.contact(grain)),
        'region above block INF INF INF INF %g INF' % (-3 * r), 'region middle cylinder z 0 0 %g 0 INF' % middle,
        'compute cover soil reduce/region middle max z', 'variable left equal count(soil,above)',
        'thermo_style custom time atoms ke c_fastest v_left c_cover', 'thermo_modify lost ignore', 'thermo %d' % look,
        'run %d' % rest, 'group plug type %d' % TOOL, 'delete_atoms group plug', 'print "OPEN"',
        'variable n loop 400', 'label again', 'variable before equal ${left}',
        'run %d' % (20 * look), 'variable passed equal ${before}-v_left',
        'if "${passed} == 0" then "jump SELF done"', 'variable c equal c_cover',
        'if "${c} < %g" then "jump SELF done"' % (opening * d), 'next n', 'jump SELF again', 'label done', ''])
    said = lammps(folder, this, text)
    before, after = said.split('\nOPEN', 1)
    resting = thermo(before)[-1]
    rows = thermo(after)
    number = len(soil_z)
    first_cover = rows[0]['c_cover']
    points, last_came, last_passed, clogged, t0 = [], rows[0]['Time'], 0, False, rows[0]['Time']
    for row in rows:
        passed = number - row['v_left']
        if passed > last_passed:
            last_passed, last_came = passed, row['Time']
        points.append((row['Time'] - t0, passed))
        clogged = row['Time'] - last_came > 9.5 * unit and row['c_cover'] >= r
        if row['Time'] - last_came > 20 * unit or row['c_cover'] < min(opening * d, 0.5 * first_cover):
            break
    all_passed = points[-1][1]
    fit = [p for p in points if p[1] >= 0.25 * all_passed and (not clogged or p[1] < all_passed)]
    rate = 0
    if len(fit) >= 4 and fit[-1][1] - fit[0][1] >= 30:
        tm, pm = statistics.mean(p[0] for p in fit), statistics.mean(p[1] for p in fit)
        rate = soil.mass * sum((t - tm) * (p - pm) for t, p in fit) / sum((t - tm) ** 2 for t, _ in fit)
    return dict(opening=opening, rate_kg_s=rate, over_beverloo=rate / beverloo(soil, opening * d, density), clogged=clogged,
                density_kg_m3=density, grains=number, passed=all_passed, time_s=points[-1][0],
                at_rest_m_s=resting['c_fastest'], before_opening=number - resting['v_left'],
                fastest_m_s=max(row['c_fastest'] for row in rows))


def heap_angle(centres, r):
    """heapProfile() of src/haptolith/lab/apparatus/heap_profile.cpp with rings of 4 R about x = y = 0, floor at 0."""
    width = 4 * r
    highest = {}
    for x, y, z in centres:
        distance = math.hypot(x, y)
        ring = int(distance / width)
        sectors = round(2 * math.pi * (ring + 0.5))
        patch = (ring, min(int((math.atan2(y, x) / (2 * math.pi) + 0.5) * sectors), sectors - 1))
        if patch not in highest or z + r > highest[patch][1]:
            highest[patch] = (distance, z + r)
    rings = {}
    for (ring, _), top in highest.items():
        rings.setdefault(ring, []).append(top)
    profile = [tuple(statistics.mean(column) for column in zip(*rings[ring])) for ring in sorted(rings)]
    summit = max(range(len(profile)), key=lambda i: profile[i][1])
    height = profile[summit][1]
    top = next(i for i in range(summit, len(profile)) if profile[i][1] < 0.8 * height)
    foot = next((i for i in range(top, len(profile)) if profile[i][1] < 0.2 * height), len(profile))
    flank = profile[top:foot]
    if len(flank) < 3:
        sys.exit('run: a heap has no slope to measure')
    slope = statistics.linear_regression(*zip(*flank)).slope
    return math.degrees(math.atan(-slope)), height


def heap(folder, grain, seed, gravity=EARTH):
    """A smooth tube of soil, 13 R wide and filled 60 R high, is lifted off a rough floor. As haptolith's reposeTest()."""
    soil = Soil()
    r = soil.radius
    inner, fill = 13 * r, 60 * r
    spread = (3 * inner ** 2 * fill / math.tan(math.radians(20))) ** (1 / 3) + 6 * r
    box = Box(2 * spread, 2 * spread, -4 * r, 3.2 * fill)
    name = 'heap-%d' % seed
    rng = rng_of(name, seed)
    grains = [g for g in rough_plate(soil, box, -r, rng) if math.hypot(g[0], g[1]) < spread]
    most = inner - (1 + soil.spread) * r
    grains += loose(soil, box, soil.number_in(math.pi * inner ** 2 * fill), 2 * r, rng, lambda x, y, z: math.hypot(x, y) < most)

    def tube(g, moving=''):
        return 'region tube cylinder z 0 0 %g 0 %g side in open 1 open 2%s\nfix tube soil wall/gran/region granular %s region tube\n' % (
            inner, box.top, moving, soil.contact(g, friction=0))

    grains = settle(folder, name, soil, box, grains, gravity, tube)
    this = '%s-%s' % (name, grain.name)
    write_data(folder / (this + '.data'), soil, box, grains)
    speed = 0.4 * math.sqrt(gravity * r)
    look = round(3 * math.sqrt(r / gravity) / soil.dt)
    at_rest = math.sqrt(2 * gravity * r / 500)
    rest = round(0.3 / soil.dt)
    text = head(soil, box, grain, this + '.data', gravity) + '\n'.join([
        'variable gap equal %g*(step>%d)*(step-%d)*dt' % (speed, rest, rest),
        tube(grain, ' move NULL NULL v_gap'),
        'compute top soil reduce max z', 'thermo_style custom time atoms ke c_fastest c_top v_gap', 'thermo_modify lost ignore', 'thermo %d' % look,
        'run %d' % rest, 'variable n loop 400', 'label again', 'run %d' % (2 * look),
        'variable over equal v_gap-c_top', 'if "${over} > 0" then "jump SELF lifted"', 'next n', 'jump SELF again',
        'label lifted', 'unfix tube', 'variable m loop 170', 'label still', 'run %d' % (2 * look),
        'variable v equal c_fastest', 'if "${v} < %g" then "jump SELF done"' % at_rest, 'next m', 'jump SELF still',
        'label done', 'write_dump soil custom %s.end id type radius x y z modify sort id format float %%.9g' % this, ''])
    rows = thermo(lammps(folder, this, text))
    end = read_dump(folder / (this + '.end'))
    angle, height = heap_angle([g[:3] for g in end], r)
    far = sum(1 for x, y, *_ in end if max(abs(x), abs(y)) > spread - 3 * r)
    return dict(angle_deg=angle, height_d=height / soil.d, grains=len(end), lost=rows[0]['Atoms'] - rows[-1]['Atoms'], at_walls=far,
                rests=rows[-1]['c_fastest'] < at_rest, fastest_m_s=max(row['c_fastest'] for row in rows), time_s=rows[-1]['Time'])


def blade(folder, grain, seed, gravity, radius_mm=2.5, depth=0.03, width=0.05):
    """An upright blade as wide as its box, which repeats itself sideways, drawn 1.5 depths. As haptolith's bladeTest()."""
    soil = Soil(radius_mm)
    r = soil.radius
    behind, ahead, tip = 1.2 * depth, 4.5 * depth, 0.8 * depth
    box = Box(behind + ahead, width, 0, 6 * depth, 'y')
    name = 'blade-%g-%d' % (gravity, seed)
    rng = rng_of('blade', seed)
    at = behind - box.x / 2
    small = r / 2  # a sheet of small spheres, at half their width
    rows, columns = round(2.5 * depth / small), round(width / small)
    sheet = [[at - small, (j + 0.5) * width / columns - width / 2, tip + small + i * small, small, TOOL]
             for i in range(rows) for j in range(columns)]
    room = 1.02 * (soil.radius * (1 + soil.spread))
    front, back = at + room, at - 2 * small - room
    number = soil.number_in(0.93 * box.x * box.y * (tip + depth))
    grains = sheet + loose(soil, box, number, 0, rng, lambda x, y, z: x > front or x < back or z < tip - room)

    def floor(g):
        return 'fix floor soil wall/gran granular %s zplane 0 NULL\n' % soil.contact(g)

    grains = settle(folder, name, soil, box, grains, gravity, floor)
    soil_z = sorted(g[2] for g in grains if g[4] == SOIL)
    surface = soil_z[int(0.98 * (len(soil_z) - 1))] + r
    low, high = 0.2 * surface, 0.8 * surface
    density = soil.mass * sum(1 for z in soil_z if low <= z < high) / (box.x * box.y * (high - low))
    this = '%s-%s' % (name, grain.name)
    write_data(folder / (this + '.data'), soil, box, grains)
    speed = math.sqrt(0.01 * gravity * depth)
    steps = round(1.5 * depth / speed / soil.dt)
    text = head(soil, box, grain, this + '.data', gravity) + side_walls(soil, box, grain) + floor(grain) + '\n'.join([
        'group blade type %d' % TOOL, 'compute draft blade reduce sum fx fz',
        'thermo_style custom time atoms ke c_fastest c_draft[1]', 'thermo_modify lost ignore', 'thermo 1000', 'run %d' % round(0.3 * math.sqrt(9.807 / gravity) / soil.dt),
        'fix go blade move linear %g 0 0' % speed,
        'fix curve all ave/time 1 20 20 c_draft[1] c_draft[2] file %s.curve' % this, 'run %d' % steps, ''])
    said = thermo(lammps(folder, this, text))
    curve = read_columns(folder / (this + '.curve'))
    level = [-row[1] for row in curve[len(curve) // 3:]]  # from 0.5 to 1.5 depths
    blocks = [statistics.mean(level[i * len(level) // 10:(i + 1) * len(level) // 10]) for i in range(10)]
    return dict(draft_n=statistics.mean(level), draft_se_n=statistics.stdev(blocks) / math.sqrt(10), density_kg_m3=density,
                depth_m=surface - tip, grains=len(soil_z), lost=said[0]['Atoms'] - said[-1]['Atoms'],
                fastest_m_s=max(row['c_fastest'] for row in said))


def cost(folder, grain, seed):
    """Steps a second of a bed at rest, periodic sideways, on one core."""
    soil = Soil()
    d = soil.d
    box = Box(16 * d, 16 * d, 0, 40 * d, 'xy')
    name = 'cost-%d' % seed
    grains = loose(soil, box, soil.number_in(box.x * box.y * 12 * d), 0, rng_of(name, seed))

    def floor(g):
        return 'fix floor soil wall/gran granular %s zplane 0 NULL\n' % soil.contact(g)

    grains = settle(folder, name, soil, box, grains, EARTH, floor)
    this = '%s-%s' % (name, grain.name)
    write_data(folder / (this + '.data'), soil, box, grains)
    rounds, steps = 5, 300
    said = lammps(folder, this, head(soil, box, grain, this + '.data', EARTH) + floor(grain) + '\n'.join(
        ['thermo_style custom time atoms ke c_fastest', 'thermo 1000', 'run 700'] + ['run %d' % steps] * rounds + ['']))
    walls = [float(line.split()[3]) for line in said.split('\n') if line.startswith('Loop time of')]
    shares = [float(line.split('%')[0]) / 100 for line in said.split('\n') if '% CPU use with' in line]
    speeds = [steps / (wall * share) for wall, share in zip(walls, shares)][1:]  # of processor time: others work here too
    return dict(steps_per_s=statistics.median(speeds), all_steps_per_s=speeds, grains=len(grains),
                at_rest_m_s=thermo(said)[-1]['c_fastest'])
