import { radiiOf, type Scene } from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';
import { Dust, flown_m, slowingTime_s } from '../../src/view/dust';
import { SoilSurface } from '../../src/view/soil_surface';
import { makePlainSoilTexture, SIDE, regolithTile, tileSun } from '../../src/view/soil_texture';
import { swarm } from '../../src/view/soil_view';
import { surfaceMesh } from '../../src/view/surface_mesh';

const RADIUS_M = 0.005;
const WIDTH_M = 0.12;
const FROM_LEFT = { x: -0.8, y: 0, z: 0.6 };

type Place = [x_m: number, y_m: number, z_m: number];

/** A layer of particles, as level as spheres can be. */
function layer(z_m: number): Place[] {
  const across = 12;
  const at_m = (nth: number): number => ((nth + 0.5) / across - 0.5) * WIDTH_M;
  return Array.from({ length: across * across }, (_, i) => [at_m(i % across), at_m(Math.floor(i / across)), z_m]);
}

function sceneOf(particles: number, surface_m = 2 * RADIUS_M): Scene {
  return {
    particles,
    radius_m: RADIUS_M,
    box: { width_m: WIDTH_M, length_m: WIDTH_M, surface_m, periodic_x: false, periodic_y: false },
    quantised: { low_m: [-0.2, -0.2, 0], high_m: [0.2, 0.2, 0.4] },
  } as unknown as Scene;
}

function recordsOf(places: Place[]): Uint16Array {
  const quantise = (value: number, low: number): number => Math.round((65535 * (value - low)) / 0.4);
  return new Uint16Array(places.flatMap(([x, y, z]) => [quantise(x, -0.2), quantise(y, -0.2), quantise(z, 0), 0]));
}

function surfaceOf(places: Place[], surface_m?: number): SoilSurface {
  const scene = sceneOf(places.length, surface_m);
  const surface = new SoilSurface(scene, radiiOf(scene), FROM_LEFT);
  surface.build(recordsOf(places), places.length);
  return surface;
}

describe('the surface of soil', () => {
  it('is level over a level layer of balls, and so is the ground around', () => {
    const surface = surfaceOf(layer(RADIUS_M));
    for (let x_m = -0.055; x_m < 0.056; x_m += 0.003)
      expect(Math.abs(surface.heightAt(x_m, 0.01) - surface.level_m)).toBeLessThan(0.1 * RADIUS_M);
    expect(surface.level_m).toBeGreaterThan(1.6 * RADIUS_M);
    expect(surface.level_m).toBeLessThan(2.01 * RADIUS_M);
    expect(surface.heightAt(0.4, 0)).toBe(surface.level_m);
    expect(surface.seen_count).toBe(144);
    expect(surface.flying_count).toBe(0);
  });

  // Two layers; the upper one has holes of this width in the corners, as packings have.
  const withHoles = (radii: number): Place[] => [
    ...layer(RADIUS_M),
    ...layer(2.6 * RADIUS_M).filter(([x, y]) => Math.max(WIDTH_M / 2 - Math.abs(x), WIDTH_M / 2 - Math.abs(y)) > radii * RADIUS_M), // prettier-ignore
  ];

  it('is level in the corners, which a packing leaves empty', () => {
    const surface = surfaceOf(withHoles(2.5), 3.6 * RADIUS_M);
    for (const [x_m, y_m] of [
      [0.058, 0.058],
      [-0.055, 0.055],
      [-0.058, -0.05],
      [0.07, -0.07],
    ] as const)
      // prettier-ignore
      expect(Math.abs(surface.heightAt(x_m, y_m) - surface.level_m)).toBeLessThan(0.3 * RADIUS_M);
  });

  it('shows what is dug in a corner, then and when the page is opened later', () => {
    const level = withHoles(2.5);
    const dug = level.filter(([x, y]) => Math.hypot(x - 0.05, y - 0.05) > 6 * RADIUS_M);
    const scene = sceneOf(level.length, 3.6 * RADIUS_M);
    const surface = new SoilSurface(scene, radiiOf(scene), FROM_LEFT);
    surface.build(recordsOf(level), level.length);
    const far: Place = [-0.055, -0.055, 2.6 * RADIUS_M];
    const rest = Array.from({ length: level.length - dug.length }, () => far);
    surface.build(recordsOf([...dug, ...rest]), level.length);
    expect(surface.heightAt(0.055, 0.055)).toBeLessThan(surface.level_m - 2 * RADIUS_M);
    expect(Math.abs(surface.heightAt(-0.055, 0.055) - surface.level_m)).toBeLessThan(0.3 * RADIUS_M);
    expect(surfaceOf(dug, 3.6 * RADIUS_M).heightAt(0.055, 0.055)).toBeLessThan(surface.level_m - 2 * RADIUS_M);
  });

  it('meets the ground around from a heap at the wall without a step', () => {
    const surface = surfaceOf([...layer(RADIUS_M), [0.055, 0, 2.8 * RADIUS_M], [0.055, 0.005, 4.4 * RADIUS_M]]);
    expect(surface.heightAt(0.055, 0.002)).toBeGreaterThan(surface.level_m + RADIUS_M);
    let before_m = surface.heightAt(0.055, 0.002);
    for (let x_m = 0.056; x_m < 0.1; x_m += 0.001) {
      const height_m = surface.heightAt(x_m, 0.002);
      expect(Math.abs(height_m - before_m)).toBeLessThan(0.0035);
      before_m = height_m;
    }
    expect(before_m).toBeCloseTo(surface.level_m, 5);
  });

  it('lies over soil that is held behind the sides', () => {
    const places: Place[] = [...layer(RADIUS_M), [0.065, 0, RADIUS_M], [0.065, 0.01, RADIUS_M], [0.065, 0, 2.5 * RADIUS_M]]; // prettier-ignore
    const surface = surfaceOf(places);
    expect(surface.heightAt(0.065, 0)).toBeGreaterThan(surface.level_m + 0.5 * RADIUS_M);
  });

  it('leaves out what is in the air, little by little, and lists it', () => {
    const over = (gap_radii: number): SoilSurface =>
      surfaceOf([...layer(RADIUS_M), [0.005, 0.005, (3 + gap_radii) * RADIUS_M]]);
    const heights = [0, 0.4, 0.8, 1.2, 1.6, 3].map((gap) => over(gap).heightAt(0.005, 0.005));
    expect(heights[0]! - over(9).level_m).toBeGreaterThan(0.3 * RADIUS_M);
    for (let i = 1; i < heights.length; ++i) expect(Math.abs(heights[i]! - heights[i - 1]!)).toBeLessThan(RADIUS_M);
    expect(Math.abs(heights.at(-1)! - over(3).level_m)).toBeLessThan(0.1 * RADIUS_M);
    expect(over(3).flying_count).toBe(1);
    expect(over(3).flying_m[0]!.z).toBeCloseTo(6 * RADIUS_M, 4);
  });

  it('takes the thickness of the tool for no gap', () => {
    const places: Place[] = [...layer(RADIUS_M), [0.005, 0.005, 4.4 * RADIUS_M]];
    const scene = sceneOf(places.length);
    const surface = new SoilSurface(scene, radiiOf(scene), FROM_LEFT);
    const tool = { at_m: [0, 0, 0.01] as [number, number, number], radius_m: 0.03, thickness_m: 0.005 };
    surface.build(recordsOf(places), places.length, [tool]);
    expect(surface.flying_count).toBe(0);
  });

  it('has a shadow on the side away from the sun', () => {
    const heap: Place[] = [0, 1, 2].flatMap((up) => layer((1 + 1.6 * (up + 1)) * RADIUS_M).filter(([x]) => Math.abs(x) < 0.011)); // prettier-ignore
    const surface = surfaceOf([...layer(RADIUS_M), ...heap]);
    expect(surface.isShaded(-0.03, 0)).toBe(false);
    expect(surface.isShaded(0, 0)).toBe(false);
    expect(surface.isShaded(0.022, 0)).toBe(true);
    expect(surface.isShaded(0.05, 0)).toBe(false);
  });

  it('says which way the sides of a heap in the air face', () => {
    const places: Place[] = [...layer(RADIUS_M), [-0.005, 0, 0.06], [0.005, 0, 0.06]];
    const surface = surfaceOf(places);
    expect(surface.aloft.outwards[3 * 144]!).toBeLessThan(0);
    expect(surface.aloft.outwards[3 * 145]!).toBeGreaterThan(0);
  });
});

describe('small grains', () => {
  it('of a swarm lie within it, the first in the middle', () => {
    const grains = swarm(80);
    expect(Array.from(grains.subarray(0, 4))).toEqual([0, 0, 0, 0]);
    for (let i = 4; i < grains.length; i += 4) {
      expect(Math.hypot(grains[i]!, grains[i + 1]!, grains[i + 2]!)).toBeLessThanOrEqual(1.0001);
      expect(grains[i + 3]!).toBeGreaterThan(0.05);
      expect(grains[i + 3]!).toBeLessThan(0.4);
    }
  });

  it('of the tile cast shadows away from the sun', () => {
    let seed = 3;
    const { heights } = regolithTile(() => (seed = (seed * 16807) % 2147483647) / 2147483647);
    expect(heights.every(Number.isFinite)).toBe(true);
    const post = new Float32Array(SIDE * SIDE);
    post[100 * SIDE + 500] = 20;
    const sun = tileSun(post, FROM_LEFT);
    expect(sun[100 * SIDE + 490]).toBe(1);
    expect(sun[100 * SIDE + 505]).toBe(0);
    expect(sun[100 * SIDE + 5]).toBe(0); // across the tile's edge
    expect(sun[100 * SIDE + 40]).toBe(1);
    expect(sun[104 * SIDE + 505]).toBe(1);
  });
});

describe('the plain tile', () => {
  it('is as bright in the mean as level soil, brighter and darker in places', () => {
    const data = Array.from(makePlainSoilTexture(FROM_LEFT).image.data as Uint8Array);
    for (const channel of [0, 1]) {
      const light = data.filter((_, i) => i % 2 === channel).map((byte) => (2 * byte) / 255);
      const mean = light.reduce((sum, value) => sum + value, 0) / light.length;
      expect(mean).toBeGreaterThan(0.85);
      expect(mean).toBeLessThan(1.05);
    }
    expect(Math.max(...data.slice(0, 20_000))).toBeLessThan(250);
    expect(Math.min(...data.slice(0, 20_000))).toBeLessThan(110);
  });
});

describe('dust', () => {
  it('flies as far as steps of its equation of motion take it', () => {
    for (const [body, gravity_m_s2] of [
      ['Moon', -1.625],
      ['Mars', -3.72],
      ['Earth', -9.81],
    ] as const) {
      const tau_s = slowingTime_s(body);
      expect(tau_s === null).toBe(body === 'Moon');
      const step_s = 1e-5;
      let [way_m, speed_m_s] = [0, 0.6];
      for (let i = 0; i < 50_000; ++i) {
        speed_m_s += step_s * (gravity_m_s2 - (tau_s === null ? 0 : speed_m_s / tau_s));
        way_m += step_s * speed_m_s;
      }
      expect(Math.abs(flown_m(0.6, gravity_m_s2, tau_s, 0.5) - way_m)).toBeLessThan(1e-4);
    }
    expect(slowingTime_s('Earth')).toBeCloseTo(0.083, 3);
  });

  it('comes from fast grains alone, and lands', () => {
    const dust = new Dust({});
    dust.setWorld('Moon', [0, 0, -1.625], { low_m: [0, 0, 0], high_m: [1, 1, 1] });
    const radii_m = new Float32Array(50).fill(0.007);
    const fast = 200; // 0.4 m/s
    const slow = 120; // 0.006 m/s
    const frame = (x: number, speed: number): Uint16Array =>
      new Uint16Array(radii_m.length * 4).map((_, k) => [x, 30_000, 30_000, speed][k % 4]!);
    for (let n = 0; n < 30; ++n) dust.take(frame(1000 + 10 * n, slow), radii_m, 0.016 * n);
    expect(dust.count).toBe(0);
    for (let n = 30; n < 60; ++n) dust.take(frame(1000 + 400 * n, fast), radii_m, 0.016 * n);
    expect(dust.count).toBeGreaterThan(200);
    expect(dust.points.visible).toBe(true);
    for (let n = 60; n < 300; ++n) dust.take(frame(30_000, slow), radii_m, 0.016 * n);
    expect(dust.count).toBe(0);
    dust.setWorld(null, [0, 0, 0], { low_m: [0, 0, 0], high_m: [1, 1, 1] }); // for a participant of a study
    for (let n = 300; n < 330; ++n) dust.take(frame(1000 + 40 * n, fast), radii_m, 0.016 * n);
    expect(dust.count).toBe(0);
    dust.setWorld('Moon', [0, 0, -1.625], { low_m: [0, 0, 0], high_m: [1, 1, 1] });
    dust.take(frame(30_000, fast), radii_m, 0);
    expect(dust.points.visible).toBe(false); // time has gone back: an animation, or another bed
  });
});

describe('the mesh of the ground', () => {
  it('has no hole between the bed and the horizon', () => {
    const at = surfaceMesh(0.2, 0.1, 10, 5, 12).getAttribute('position');
    const inner = Array.from({ length: at.count }, (_, i) => i).filter((i) => at.getZ(i) < 0);
    expect(inner.length).toBeGreaterThan(0);
    for (const i of inner) {
      expect(Math.abs(at.getX(i))).toBeLessThan(0.1);
      expect(Math.abs(at.getY(i))).toBeLessThan(0.05);
    }
    expect(Math.max(...Array.from({ length: at.count }, (_, i) => Math.hypot(at.getX(i), at.getY(i))))).toBeCloseTo(12);
  });
});
