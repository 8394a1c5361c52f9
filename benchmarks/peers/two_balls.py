#!/usr/bin/env python3
"""Computes the scene `impact` directly from the equations, with either engine's rule for damping across the contact.

    benchmarks/peers/two_balls.py build/peers/impact-1.json

Prints the distance of each engine's path from that of either rule, relative to its length. Rules, with xi the spring across
the contact and v the sliding speed:

    haptolith   |k_t xi + c_t v| <= mu_p F_elastic
    yade        |k_t xi| <= mu_p F_damped;  the damper's c_t v is added where it sticks
"""

import json
import math
import sys


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def path_of(scene, rule):
    dt, mass, mu, k_t, c_t = (scene[key] for key in ('dt_s', 'mass_kg', 'mu', 'k_t_n_m', 'c_t_n_s_m'))
    balls = scene['particles'][:2]
    place = [list(ball[0:3]) for ball in balls]
    velocity = [list(ball[4:7]) for ball in balls]
    xi = [0.0] * 3
    path = []
    for _ in range(scene['steps']):
        apart = [a - b for a, b in zip(*place)]
        distance = math.sqrt(dot(apart, apart))
        normal = [x / distance for x in apart]
        overlap = balls[0][3] + balls[1][3] - distance
        force = [0.0] * 3
        if overlap > 0:
            relative = [a - b for a, b in zip(*velocity)]
            parting = dot(relative, normal)
            slip = [v - parting * n for v, n in zip(relative, normal)]
            elastic = scene['k_n_m'] * overlap
            damped = max(0.0, elastic - scene['c_n_s_m'] * parting)
            stale = dot(xi, normal)
            xi = [x - stale * n + v * dt for x, n, v in zip(xi, normal, slip)]
            damper = [c_t * v for v in slip]
            wanted = [k_t * x + (c if rule == 'haptolith' else 0) for x, c in zip(xi, damper)]
            limit = mu * (elastic if rule == 'haptolith' else damped)
            size = math.sqrt(dot(wanted, wanted))
            if size > limit:
                wanted = [w * limit / size for w in wanted]
                xi = [w / k_t for w in wanted]
            elif rule == 'yade':
                wanted = [w + c for w, c in zip(wanted, damper)]
            force = [damped * n - w for n, w in zip(normal, wanted)]
        else:
            xi = [0.0] * 3
        for ball, sign in ((0, 1), (1, -1)):
            for axis in range(3):
                velocity[ball][axis] += sign * force[axis] * dt / mass
                place[ball][axis] += velocity[ball][axis] * dt
        path.append(list(place[0]))
    return path


def main():
    scene_path = sys.argv[1]
    with open(scene_path) as file:
        scene = json.load(file)
    if scene['steps_per_row'] != 1 or scene['gravity_m_s2'] != 0:
        sys.exit('two_balls.py: this is not the scene "impact"')
    for rule in ('haptolith', 'yade'):
        path = path_of(scene, rule)
        length = math.dist(path[-1], scene['particles'][0][:3])
        for engine in ('haptolith', 'yade'):
            with open(scene_path.replace('.json', '-%s.txt' % engine)) as file:
                curve = [[float(x) for x in line.split()[7:10]] for line in file if line[0] != '#']
            print("rule of %-9s  engine %-9s  %.1e" % (rule, engine, max(map(math.dist, path, curve)) / length))


if __name__ == '__main__':
    main()
