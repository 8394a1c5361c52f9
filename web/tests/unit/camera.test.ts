import type { Scene } from 'haptolith-protocol';
import { Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { VIEW_NAMES } from '../../src/settings';
import { BoxView } from '../../src/view/box_view';
import { OrbitCamera } from '../../src/view/camera';

const sceneOf = (width_m: number): Scene =>
  ({ box: { width_m, length_m: width_m, surface_m: Math.min(0.09, width_m / 3) } }) as unknown as Scene;

/** Returns the fractions of the picture's width and height that the box fills, and the maximum distance of its
 * corners from the centre. */
function filled(orbit: OrbitCamera, scene: Scene): { wide: number; high: number; farthest: number } {
  const half_m = scene.box.width_m / 2;
  const corners = [-half_m, half_m].flatMap((x) =>
    [-half_m, half_m].flatMap((y) =>
      [0, BoxView.wallHeight(scene)].map((z) => new Vector3(x, y, z).project(orbit.camera)),
    ),
  );
  const span = (values: number[]): number => (Math.max(...values) - Math.min(...values)) / 2;
  return {
    wide: span(corners.map(({ x }) => x)),
    high: span(corners.map(({ y }) => y)),
    farthest: Math.max(...corners.flatMap(({ x, y }) => [Math.abs(x), Math.abs(y)])),
  };
}

describe('a named view', () => {
  for (const width_m of [0.126, 0.3, 1])
    for (const aspect of [0.55, 1, 1.94])
      for (const name of VIEW_NAMES)
        it(`fills the picture with a box of ${width_m} m: ${name}, ${aspect}`, () => {
          const orbit = new OrbitCamera();
          const scene = sceneOf(width_m);
          orbit.setScene(scene);
          orbit.setAspect(aspect);
          orbit.setView(name, false);
          const { wide, high, farthest } = filled(orbit, scene);
          expect(farthest).toBeLessThan(0.95);
          expect(Math.max(wide, high)).toBeLessThan(0.66);
          expect(Math.max(wide, high)).toBeGreaterThan(0.45);
          const raised = new Vector3(0, 0, 0.12).project(orbit.camera);
          expect(Math.abs(raised.y)).toBeLessThan(0.95);
        });

  it('leaves what lies over its top free of the box and of a raised tool', () => {
    const orbit = new OrbitCamera();
    const scene = sceneOf(0.126);
    orbit.setScene(scene);
    orbit.setAspect(1.16, 0.3);
    for (const name of VIEW_NAMES) {
      orbit.setView(name, false);
      expect(new Vector3(0, 0, name === 'top' ? 0.04 : 0.1).project(orbit.camera).y).toBeLessThan(0.4);
      expect(filled(orbit, scene).farthest).toBeLessThan(0.98);
    }
  });

  it('is framed anew for another picture, unless the eye was moved', () => {
    const orbit = new OrbitCamera();
    orbit.setScene(sceneOf(0.126));
    orbit.setAspect(2);
    const wide_m = orbit.camera.position.length();
    orbit.setAspect(0.5);
    const upright_m = orbit.camera.position.length();
    expect(upright_m).toBeGreaterThan(1.2 * wide_m);
    orbit.zoomBy(1.5);
    const moved = orbit.camera.position.clone();
    orbit.setAspect(2);
    expect(orbit.camera.position.distanceTo(moved)).toBeLessThan(1e-9);
    orbit.setView('three-quarter', false);
    expect(orbit.camera.position.length()).toBeCloseTo(wide_m, 6);
  });
});
