// Particles without support, which the tool carries or throws, and a few spheres that represent them and cast their
// shadow.

import { Vector4 } from 'three';
import { MOST_FLYING } from './height_field';

// Particles nearer than this to each other form a heap; only the first MOST_IN_HEAPS particles are examined.
const HEAP_RADII = 5;
const MOST_IN_HEAPS = 400;

export class Aloft {
  /** centres and radii of spheres that represent them; the first `ball_count` are valid */
  readonly balls_m = Array.from({ length: MOST_FLYING }, () => new Vector4());
  ball_count = 0;
  /** outward direction of the heap that contains a particle aloft, x, y, z; 0 for those on the bed and for single
   * ones */
  readonly outwards: Float32Array;
  /** x, y, z and radius of each, m */
  private readonly places_m: number[] = [];
  private readonly particles: number[] = [];

  constructor(particles: number) {
    this.outwards = new Float32Array(3 * particles);
  }

  clear(): void {
    for (const i of this.particles) this.outwards.fill(0, 3 * i, 3 * i + 3);
    this.places_m.length = this.particles.length = this.ball_count = 0;
  }

  add(particle: number, x_m: number, y_m: number, z_m: number, radius_m: number): void {
    this.places_m.push(x_m, y_m, z_m, radius_m);
    this.particles.push(particle);
  }

  /** Computes spheres and directions. To be called after the last add(). */
  gather(): void {
    this.makeBalls();
    this.findOutwards();
  }

  /** Adds the sphere of another flying object; it replaces the last sphere if there are too many. */
  addBall(x_m: number, y_m: number, z_m: number, radius_m: number): void {
    this.ball_count = Math.min(MOST_FLYING, this.ball_count + 1);
    this.balls_m[this.ball_count - 1]!.set(x_m, y_m, z_m, radius_m);
  }

  private makeBalls(): void {
    const { places_m, balls_m } = this;
    const count = places_m.length / 4;
    const groups = Math.min(MOST_FLYING, count);
    const sums = new Float64Array(5 * groups);
    for (let i = 0; i < count; ++i) {
      const [x, y, z, r] = places_m.slice(4 * i, 4 * i + 4) as [number, number, number, number];
      let group = i;
      if (i >= groups) {
        let nearest = Infinity;
        for (let g = 0; g < groups; ++g) {
          const away = Math.hypot(x - places_m[4 * g]!, y - places_m[4 * g + 1]!, z - places_m[4 * g + 2]!);
          if (away < nearest) [nearest, group] = [away, g];
        }
      }
      for (const [k, value] of [x, y, z, r ** 3, 1].entries()) sums[5 * group + k]! += value;
    }
    this.ball_count = groups;
    for (let g = 0; g < groups; ++g) {
      const n = sums[5 * g + 4]!;
      // Touching spheres leave a third of the volume empty.
      const radius_m = Math.cbrt((n > 1 ? 1.5 : 1.2) * sums[5 * g + 3]!);
      balls_m[g]!.set(sums[5 * g]! / n, sums[5 * g + 1]! / n, sums[5 * g + 2]! / n, radius_m);
    }
  }

  /** Computes directions away from the neighbours of each particle, as normals of the heap on the tool. */
  private findOutwards(): void {
    const { places_m, particles, outwards } = this;
    const count = Math.min(MOST_IN_HEAPS, particles.length);
    for (let a = 0; a < count; ++a)
      for (let b = 0; b < a; ++b) {
        const away = [0, 1, 2].map((axis) => places_m[4 * a + axis]! - places_m[4 * b + axis]!);
        const reach_m = HEAP_RADII * places_m[4 * a + 3]!;
        const squared = away[0]! ** 2 + away[1]! ** 2 + away[2]! ** 2;
        if (squared > reach_m * reach_m) continue;
        for (let axis = 0; axis < 3; ++axis) {
          outwards[3 * particles[a]! + axis]! += away[axis]! / reach_m;
          outwards[3 * particles[b]! + axis]! -= away[axis]! / reach_m;
        }
      }
  }
}
