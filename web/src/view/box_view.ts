// The box around the bed: thin edges, barely visible walls, and regular marks along the floor (every 10 mm for a box of
// 126 mm).

import type { Scene } from 'haptolith-protocol';
import {
  BoxGeometry,
  BufferGeometry,
  DoubleSide,
  EdgesGeometry,
  Float32BufferAttribute,
  Group,
  LineBasicMaterial,
  LineDashedMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
} from 'three';
import { niceStep } from './colour_maps';

// Maximum reach of soil that is held behind the sides.
const MOST_HELD_RADII = 4;

export class BoxView {
  readonly group = new Group();
  private built_for = '';
  private readonly edges = new LineBasicMaterial({ color: '#dfe6ee', transparent: true, opacity: 0.42 });
  private readonly open_edges = new LineDashedMaterial({
    color: '#dfe6ee',
    transparent: true,
    opacity: 0.42,
    dashSize: 0.004,
    gapSize: 0.004,
  });
  private readonly pane = new MeshBasicMaterial({
    color: '#dfe9f5',
    transparent: true,
    opacity: 0.035,
    side: DoubleSide,
    depthWrite: false,
  });

  /** @param reach_m  extent of the outermost spheres from the centre; the box includes soil held behind the sides */
  setScene(scene: Scene, reach_m: readonly [x: number, y: number] | null = null): void {
    const wanted = JSON.stringify([scene.box, reach_m]);
    if (wanted === this.built_for) return;
    this.built_for = wanted;
    for (const child of [...this.group.children]) {
      this.group.remove(child);
      (child as Mesh).geometry.dispose();
    }
    this.build(scene, reach_m);
  }

  /** Height of the drawn walls, in m. They are unlimited in the simulation, but a picture needs an end. */
  static wallHeight(scene: Scene): number {
    return scene.box.surface_m + 0.16 * Math.max(scene.box.width_m, scene.box.length_m);
  }

  private build(scene: Scene, reach_m: readonly [x: number, y: number] | null): void {
    const { periodic_x, periodic_y } = scene.box;
    const held_m = MOST_HELD_RADII * scene.radius_m;
    const around = (side_m: number, reach_m = 0): number =>
      Math.max(side_m, Math.min(2 * reach_m, side_m + 2 * held_m));
    const width_m = periodic_x ? scene.box.width_m : around(scene.box.width_m, reach_m?.[0]);
    const length_m = periodic_y ? scene.box.length_m : around(scene.box.length_m, reach_m?.[1]);
    const height_m = BoxView.wallHeight(scene);
    const walls = new BoxGeometry(width_m, length_m, height_m).translate(0, 0, height_m / 2);
    // Soil that leaves a periodic side enters at the opposite one. That is not a wall, so its edge is dashed.
    const periodic = periodic_x || periodic_y;
    const lines = new LineSegments(new EdgesGeometry(walls), periodic ? this.open_edges : this.edges);
    lines.computeLineDistances();
    this.group.add(lines);
    if (!periodic) {
      const panes = new Mesh(walls, this.pane);
      panes.renderOrder = 5;
      this.group.add(panes);
    }
    this.group.add(this.ruler(width_m, length_m));
  }

  private ruler(width_m: number, length_m: number): LineSegments {
    const step_m = niceStep((Math.min(width_m, length_m) * 1000) / 13) / 1000;
    const at: number[] = [];
    const marks = (half_m: number, put: (along_m: number, out_m: number) => void): void => {
      const count = Math.floor(half_m / step_m + 1e-6);
      for (let i = -count; i <= count; ++i) put(i * step_m, i % 5 === 0 ? 0.055 : 0.028);
    };
    const longer_m = Math.max(width_m, length_m);
    marks(width_m / 2, (x, out) => at.push(x, -length_m / 2, 0.0003, x, -length_m / 2 - out * longer_m, 0.0003));
    marks(length_m / 2, (y, out) => at.push(width_m / 2, y, 0.0003, width_m / 2 + out * longer_m, y, 0.0003));
    const geometry = new BufferGeometry().setAttribute('position', new Float32BufferAttribute(at, 3));
    return new LineSegments(geometry, this.edges);
  }
}
