import type { Scene } from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';
import { niceStep, scaleOf } from '../../src/view/colour_maps';
import { HeightField } from '../../src/view/height_field';
import { flatGeometry } from '../../src/view/mesh_geometry';
import { Pace } from '../../src/view/pace';
import { Resolution } from '../../src/view/resolution';
import { lookOf } from '../../src/view/body_looks';

const SCENE = {
  particles: 4,
  radius_m: 0.01,
  box: { width_m: 0.2, length_m: 0.1, surface_m: 0.04, periodic_x: false, periodic_y: false },
  quantised: { low_m: [-0.2, -0.2, 0], high_m: [0.2, 0.2, 0.4] },
} as unknown as Scene;

const quantise = (value: number, low: number, high: number): number =>
  Math.round((65535 * (value - low)) / (high - low));

describe('the height field', () => {
  it('is as high as the top of a grain, and bare ground beside it', () => {
    const field = new HeightField(SCENE);
    const record = [quantise(0.05, -0.2, 0.2), quantise(0.02, -0.2, 0.2), quantise(0.03, 0, 0.4), 0];
    field.build(new Uint16Array(record), 1);
    expect(field.heightAt(0.05, 0.02)).toBeCloseTo(0.04, 3);
    expect(field.heightAt(0.05 + 0.008, 0.02)).toBeCloseTo(0.036, 2);
    expect(field.heightAt(0.05 + 0.015, 0.02)).toBe(0);
    expect(field.heightAt(9, 9)).toBe(0);
    expect(field.top_m).toBeCloseTo(0.04, 3);
  });

  it('knows grains of several sizes, in the order of the records', () => {
    const grains = [{ count: 1, radius_m: 0.01 }, { count: 2, radius_m: 0.0025 }]; // prettier-ignore
    const field = new HeightField({ ...SCENE, particles: 3, grains });
    const grain = (x: number, z: number): number[] => [quantise(x, -0.2, 0.2), quantise(0, -0.2, 0.2), quantise(z, 0, 0.4), 0]; // prettier-ignore
    field.build(new Uint16Array([...grain(-0.05, 0.01), ...grain(0.05, 0.0025), ...grain(0, 0.02)]), 3);
    expect(field.heightAt(-0.05, 0)).toBeCloseTo(0.02, 3);
    expect(field.heightAt(-0.043, 0)).toBeGreaterThan(0.015);
    expect(field.heightAt(0.05, 0)).toBeCloseTo(0.005, 3);
    expect(field.heightAt(0.057, 0)).toBe(0);
    expect(field.flying_count).toBe(1); // 7 of its radii above the ground
    expect(field.flying_m[0]!.w).toBeCloseTo(0.0025, 6);
  });

  it('leaves out grains in the air, and lists them', () => {
    const field = new HeightField(SCENE);
    const grain = (x: number, z: number): number[] => [quantise(x, -0.2, 0.2), quantise(0, -0.2, 0.2), quantise(z, 0, 0.4), 0]; // prettier-ignore
    const records = new Uint16Array([...grain(0, 0.09), ...grain(0, 0.11), ...grain(0, 0.01), ...grain(0.05, 0.02)]);
    field.build(records, 4);
    expect(field.heightAt(0, 0)).toBeCloseTo(0.02, 3);
    expect(field.heightAt(0.05, 0)).toBeCloseTo(0.03, 3);
    expect(field.flying_count).toBe(2);
    expect(field.flying_m[0]!.z).toBeCloseTo(0.09, 3);
    expect(field.flying_m[1]!.z).toBeCloseTo(0.11, 3);
  });

  it('keeps what the tool carries', () => {
    const field = new HeightField(SCENE);
    const record = [quantise(0, -0.2, 0.2), quantise(0, -0.2, 0.2), quantise(0.1, 0, 0.4), 0];
    field.build(new Uint16Array(record), 1, [{ at_m: [0, 0.01, 0.08], radius_m: 0.02 }]);
    expect(field.flying_count).toBe(0);
    expect(field.top_m).toBeCloseTo(0.11, 3);
  });

  it('leaves out grains beyond its edge without a trace', () => {
    const field = new HeightField(SCENE);
    field.build(new Uint16Array([65535, 65535, 65535, 0, 0, 0, 65535, 0]), 2);
    expect(field.top_m).toBe(0);
  });
});

describe('a stone', () => {
  // A wedge whose top slopes along x.
  const at = (x: number, z: number): Float32Array => {
    const [a, b, c] = [[x - 0.03, -0.03, z], [x + 0.03, -0.03, z + 0.02], [x, 0.04, z + 0.01]]; // prettier-ignore
    const d = [x, 0, z - 0.01];
    return new Float32Array([a, b, c, a, d, b, b, d, c, c, d, a].flat() as number[]);
  };

  it('is as high as its top, over the soil that it covers', () => {
    const field = new HeightField(SCENE);
    const record = [quantise(0.04, -0.2, 0.2), quantise(0, -0.2, 0.2), quantise(0.01, 0, 0.4), 0];
    field.build(new Uint16Array(record), 1, [], [at(-0.03, 0.03)]);
    expect(field.heightAt(-0.03, 0)).toBeCloseTo(0.04, 3);
    expect(field.heightAt(-0.045, -0.02)).toBeCloseTo(0.035, 3);
    expect(field.heightAt(-0.06, 0.03)).toBe(0);
    expect(field.heightAt(0.04, 0)).toBeCloseTo(0.02, 3);
    expect(field.flying_count).toBe(0);
  });

  it('is no height in the air, but casts a round shadow', () => {
    const field = new HeightField(SCENE);
    field.build(new Uint16Array(0), 0, [], [at(0, 0.1)]);
    expect(field.top_m).toBe(0);
    expect(field.flying_count).toBe(1);
    const [x, y, z, radius_m] = field.flying_m[0]!.toArray();
    expect([x, y, z]).toEqual([0, -0.005, 0.105].map((value) => expect.closeTo(value, 4) as number));
    expect(radius_m).toBeGreaterThan(0.015);
    expect(radius_m).toBeLessThan(0.045);
  });
});

describe('flat triangles', () => {
  it('have one direction each', () => {
    const points_m = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]);
    const normals = flatGeometry({ points_m, triangles: new Uint32Array([0, 2, 1, 0, 1, 3]) }).getAttribute('normal');
    expect(Array.from(normals.array)).toEqual([0, 0, -1, 0, 0, -1, 0, 0, -1, 0, -1, 0, 0, -1, 0, 0, -1, 0]);
  });
});

describe('the resolution', () => {
  const run = (resolution: Resolution, delta_ms: number, frames: number): void => {
    for (let i = 0, t = 0; i < frames; ++i, t += delta_ms) resolution.drawn(t);
  };

  it('falls when frames are slow, then gives up detail, and has a floor', () => {
    const resolution = new Resolution(1, true, false);
    run(resolution, 60, 45);
    expect(resolution.ratio).toBeLessThan(1);
    run(resolution, 60, 2000);
    expect(resolution.detailed).toBe(false);
    expect(resolution.ratio).toBe(0.4);
  });

  it('stays when frames are in time', () => {
    const resolution = new Resolution(2, true, false);
    run(resolution, 16.7, 500);
    expect(resolution.ratio).toBe(2);
  });

  it('falls within seconds at less than one frame per second', () => {
    const resolution = new Resolution(1, true, false);
    run(resolution, 1500, 10);
    expect(resolution.ratio).toBeLessThan(0.7);
  });

  it('stays where the processor draws as often as is wanted, and falls where it cannot', () => {
    const resolution = new Resolution(1, true, true);
    const { ratio } = resolution;
    for (let i = 0; i < 500; ++i) resolution.drawn(83 * i, 1000 / 12);
    expect(resolution.ratio).toBe(ratio);
    for (let i = 0; i < 50; ++i) resolution.drawn(100_000 + 400 * i, 1000 / 12);
    expect(resolution.ratio).toBeLessThan(ratio);
    expect(resolution.detailed).toBe(false);
  });

  it('is left alone for pictures', () => {
    const resolution = new Resolution(2, false, false);
    run(resolution, 500, 500);
    expect(resolution.ratio).toBe(2);
  });
});

describe('the pace of frames', () => {
  const framesInASecond = (pace: Pace): number => {
    let count = 0;
    for (let t = 0, frame = 0; frame < 60; ++frame, t += 1000 / 60)
      if (pace.due(t)) {
        pace.drawn(t);
        ++count;
      }
    return count;
  };

  it('is that of the screen with a graphics card, and slower where the processor draws', () => {
    expect(framesInASecond(new Pace(false))).toBe(60);
    expect(framesInASecond(new Pace(true))).toBe(12);
  });

  it('halves while the loop is late, and comes back when it is in time again', () => {
    const pace = new Pace(true);
    pace.watchLoop(0, 0);
    pace.watchLoop(2500, 40);
    expect(framesInASecond(pace)).toBe(6);
    pace.watchLoop(5000, 40);
    expect(pace.interval_ms).toBeGreaterThan(160);
    for (let ticks = 7500; ticks <= 20_000; ticks += 2500) pace.watchLoop(ticks, 41);
    expect(pace.interval_ms).toBeLessThan(84);
    const card = new Pace(false);
    card.watchLoop(0, 0);
    card.watchLoop(2500, 2500);
    expect(framesInASecond(card)).toBe(60);
  });
});

describe('a legend', () => {
  it('has ticks within its colours', () => {
    for (const mode of ['force', 'speed', 'depth'] as const)
      for (const { at } of scaleOf(mode, 0.041)!.ticks) {
        expect(at).toBeGreaterThanOrEqual(-1e-9);
        expect(at).toBeLessThanOrEqual(1 + 1e-9);
      }
  });

  it('has none where colours mean no number', () => {
    expect(scaleOf('plain', 0.04)).toBeNull();
    expect(scaleOf('sleep', 0.04)).toBeNull();
  });

  it('steps by 1, 2 or 5', () => {
    expect([0.9, 1, 1.1, 3, 7, 30].map(niceStep)).toEqual([1, 1, 2, 5, 10, 50]);
  });
});

describe('a body', () => {
  it('that nobody knows looks like the Moon', () => {
    expect(lookOf(null)).toBe(lookOf('Moon'));
    expect(lookOf('Venus')).toBe(lookOf('Moon'));
    expect(lookOf('Mars')).not.toBe(lookOf('Moon'));
  });
});
