// The soil at a remote robot's site, as its operator knows it: a block with that surface and the robot's tool. It is
// seen from the eye of the bed, in a corner of the picture.

import type { Robot, Scene, Site } from 'haptolith-protocol';
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  HemisphereLight,
  Mesh,
  MeshLambertMaterial,
  PerspectiveCamera,
  Scene as World,
} from 'three';
import { lookOf } from './body_looks';
import { LOW_SUN } from './light_shader';
import { RobotView } from './robot_view';

const BACKGROUND = '#10151a';
// Depth of the block's bottom below its lowest point, as a fraction of its longer side.
const BELOW = 0.08;
const WIDEST_FOV_DEG = 75;
// Fraction of the bounding sphere that is in the picture, because the block does not fill it.
const FILLS = 0.85;

export class SiteView {
  readonly world = new World();
  private readonly tool = new RobotView();
  private readonly soil = new MeshLambertMaterial({ side: DoubleSide });
  private readonly sun = new DirectionalLight(0xffffff, 2.4);
  private readonly fill = new HemisphereLight(0xffffff, 0x333333, 0.8);
  private readonly block = new Mesh(new BufferGeometry(), this.soil);
  private readonly camera = new PerspectiveCamera();
  private shown: Site | null = null;
  private surface_m = 0;

  constructor() {
    this.world.background = new Color(BACKGROUND);
    this.sun.position.copy(LOW_SUN);
    this.fill.position.set(0, 0, 1);
    this.world.add(this.sun, this.fill, this.block, this.tool.group);
  }

  get visible(): boolean {
    return this.shown !== null;
  }

  setScene(scene: Scene, neutral: boolean): void {
    const look = lookOf(neutral ? 'Moon' : scene.body);
    this.soil.color.set(look.soil);
    this.surface_m = scene.box.surface_m;
    this.tool.setTool(scene.tool);
    if (this.shown) this.build(this.shown);
  }

  /** Sets the robot's last report; true if the site has changed. */
  setRobot(robot: Robot | null, now_ms: number): boolean {
    const site = robot?.site ?? null;
    const before = this.shown;
    this.shown = site;
    this.tool.setRobot(robot, now_ms);
    const changed = site === null ? before !== null : before === null || !isSame(before, site);
    if (site && changed) this.build(site);
    return changed;
  }

  /** Advances the tool's motion; true while it continues. */
  advance(now_ms: number): boolean {
    return this.tool.advance(now_ms);
  }

  /** Returns a camera at the eye of the bed with the complete site in its picture. */
  cameraBeside(camera: PerspectiveCamera, aspect: number): PerspectiveCamera {
    const { center, radius } = this.block.geometry.boundingSphere!;
    this.camera.up.copy(camera.up);
    this.camera.position.copy(camera.position);
    this.camera.lookAt(center);
    const sine = Math.min(1, radius / this.camera.position.distanceTo(center));
    const fov_deg = (360 / Math.PI) * Math.asin(sine);
    this.camera.fov = Math.min(WIDEST_FOV_DEG, FILLS * fov_deg * Math.max(1, 1 / aspect));
    this.camera.aspect = aspect;
    this.camera.near = camera.near;
    this.camera.far = camera.far;
    this.camera.updateProjectionMatrix();
    return this.camera;
  }

  private build(site: Site): void {
    this.block.geometry.dispose();
    this.block.geometry = blockOf(site, this.surface_m);
  }
}

/** Whether two maps show the same surface in the same place. */
export function isSame(a: Site, b: Site): boolean {
  const grid = (site: Site): number[] => [site.columns, site.rows, site.cell_m, ...site.corner_m];
  const equal = (one: (number | null)[], other: (number | null)[]): boolean =>
    one.every((value, i) => value === other[i]);
  return equal(grid(a), grid(b)) && equal(a.heights_mm, b.heights_mm);
}

/** Builds the surface through the centres of all cells, and sides down from its edge. Unknown cells are holes. */
export function blockOf(site: Site, surface_m: number): BufferGeometry {
  const { columns, rows, cell_m } = site;
  const [x_m, y_m] = site.corner_m as [number, number];
  const known = site.heights_mm.map((height) => (height === null ? null : surface_m + height / 1000));
  const lowest = known.reduce((low: number, z) => (z === null ? low : Math.min(low, z)), surface_m);
  const under = lowest - BELOW * cell_m * Math.max(columns, rows);
  const at: number[] = [];
  const corners: number[] = [];
  const put = (column: number, row: number, z: number): number =>
    at.push(x_m + (column + 0.5) * cell_m, y_m + (row + 0.5) * cell_m, z) / 3 - 1;
  const quad = (a: number, b: number, c: number, d: number): void => void corners.push(a, b, c, a, c, d);
  for (let row = 0; row < rows; ++row)
    for (let column = 0; column < columns; ++column) put(column, row, known[row * columns + column] ?? surface_m);
  for (let row = 0; row + 1 < rows; ++row)
    for (let column = 0; column + 1 < columns; ++column) {
      const first = row * columns + column;
      const around = [first, first + 1, first + columns + 1, first + columns] as const;
      if (around.every((cell) => known[cell] !== null)) quad(...around);
    }
  // Sides have separate corners, so that the edge is sharp.
  const wall = (from: [number, number], step: [number, number], count: number): void => {
    for (let i = 0; i + 1 < count; ++i) {
      const ends = [i, i + 1].map((k) => [from[0] + k * step[0], from[1] + k * step[1]] as [number, number]);
      const heights = ends.map(([column, row]) => known[row * columns + column]);
      if (heights.some((z) => z === null)) continue;
      const [top_a, top_b] = ends.map(([column, row], k) => put(column, row, heights[k]!)) as [number, number];
      const [foot_a, foot_b] = ends.map(([column, row]) => put(column, row, under)) as [number, number];
      quad(top_a, foot_a, foot_b, top_b);
    }
  };
  wall([0, 0], [1, 0], columns);
  wall([columns - 1, 0], [0, 1], rows);
  wall([columns - 1, rows - 1], [-1, 0], columns);
  wall([0, rows - 1], [0, -1], rows);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(at), 3));
  geometry.setIndex(corners);
  geometry.computeVertexNormals();
  geometry.computeBoundingSphere();
  return geometry;
}
