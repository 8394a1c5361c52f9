// A mock of the program's bed: round particles that push each other apart and settle. Its physics is not realistic; it
// only provides visible particles and forces for the page.

import type { Pose, Tool, Vec3 } from 'haptolith-protocol';
import { shapeOf } from '../src/tool_shapes';

const ROUNDS = 3;

export class MockBed {
  readonly count: number;
  readonly position_m: Float32Array;
  readonly speed_m_s: Float32Array;
  readonly force_n: Float32Array;
  readonly still_ticks: Uint8Array;
  force_on_hand_n: Vec3 = [0, 0, 0];
  torque_on_hand_nm: Vec3 = [0, 0, 0];
  private readonly cells = new Map<number, number[]>();

  constructor(
    readonly width_m: number,
    readonly radius_m: number,
    layers: number,
  ) {
    const pitch_m = 1.96 * radius_m;
    const across = Math.floor((width_m - 0.2 * radius_m) / pitch_m);
    this.count = across * across * layers;
    this.position_m = new Float32Array(3 * this.count);
    this.speed_m_s = new Float32Array(this.count);
    this.force_n = new Float32Array(this.count);
    this.still_ticks = new Uint8Array(this.count).fill(200);
    let seed = 1;
    const random = (): number => (seed = (seed * 16807) % 2147483647) / 2147483647 - 0.5;
    let i = 0;
    for (let layer = 0; layer < layers; ++layer)
      for (let row = 0; row < across; ++row)
        for (let column = 0; column < across; ++column, ++i) {
          const shift = (layer % 2) * 0.5 - 0.25;
          this.position_m[3 * i] = (column + 0.5 + shift - across / 2 + 0.12 * random()) * pitch_m;
          this.position_m[3 * i + 1] = (row + 0.5 + shift - across / 2 + 0.12 * random()) * pitch_m;
          this.position_m[3 * i + 2] = radius_m * (1 + 1.5 * layer + 0.1 * random());
        }
    this.settle();
  }

  get awake(): number {
    let count = 0;
    for (const ticks of this.still_ticks) if (ticks < 200) ++count;
    return count;
  }

  /** Advances all particles by `dt_s`; the tool is fixed. */
  step(dt_s: number, tool: Tool, pose: Pose): void {
    const before = this.position_m.slice();
    for (let i = 0; i < this.count; ++i) this.position_m[3 * i + 2]! -= 0.02 * this.radius_m;
    this.force_n.fill(0);
    this.pushedByTool(tool, pose);
    for (let round = 0; round < ROUNDS; ++round) this.pushApart();
    for (let i = 0; i < this.count; ++i) {
      const dx = this.position_m[3 * i]! - before[3 * i]!;
      const dy = this.position_m[3 * i + 1]! - before[3 * i + 1]!;
      const dz = this.position_m[3 * i + 2]! - before[3 * i + 2]!;
      const moved = Math.hypot(dx, dy, dz);
      // Friction holds particles that move very little.
      if (moved < 0.04 * this.radius_m) {
        for (const axis of [0, 1, 2]) this.position_m[3 * i + axis] = before[3 * i + axis]!;
        this.speed_m_s[i] = 0;
        this.still_ticks[i] = Math.min(200, this.still_ticks[i]! + 4);
      } else {
        this.speed_m_s[i] = moved / dt_s;
        this.still_ticks[i] = 0;
      }
    }
  }

  private settle(): void {
    for (let i = 0; i < this.count; ++i) this.force_n[i] = 0.002 * (1 + i / 40);
  }

  private pushedByTool(tool: Tool, pose: Pose): void {
    const [w, x, y, z] = pose.rotation;
    const force: Vec3 = [0, 0, 0];
    const torque: Vec3 = [0, 0, 0];
    const half = halfSize(tool);
    for (let i = 0; i < this.count; ++i) {
      const d: Vec3 = [0, 1, 2].map((axis) => this.position_m[3 * i + axis]! - pose.position_m[axis]!) as Vec3;
      if (Math.hypot(...d) > Math.hypot(...half) + this.radius_m) continue;
      const local = rotate([w, -x, -y, -z], d);
      const nearest = local.map((value, axis) => Math.min(half[axis]!, Math.max(-half[axis]!, value))) as Vec3;
      const way = local.map((value, axis) => value - nearest[axis]!) as Vec3;
      const gap = Math.hypot(...way);
      const deep = this.radius_m - gap;
      if (deep <= 0) continue;
      const normal = gap > 1e-9 ? (way.map((value) => value / gap) as Vec3) : ([0, 0, 1] as Vec3);
      const out = rotate(pose.rotation, normal);
      const size_n = 60 * deep;
      out.forEach((value, axis) => {
        this.position_m[3 * i + axis]! += 0.5 * deep * value;
        force[axis]! -= size_n * value;
      });
      this.force_n[i]! += size_n;
      torque[0] -= size_n * (d[1] * out[2] - d[2] * out[1]);
      torque[1] -= size_n * (d[2] * out[0] - d[0] * out[2]);
      torque[2] -= size_n * (d[0] * out[1] - d[1] * out[0]);
    }
    const most_n = 12;
    const size_n = Math.hypot(...force);
    const share = size_n > most_n ? most_n / size_n : 1;
    this.force_on_hand_n = force.map((value) => value * share) as Vec3;
    this.torque_on_hand_nm = torque.map((value) => value * share) as Vec3;
  }

  private cellOf(i: number): number {
    const size = 2 * this.radius_m;
    const cell = (axis: number): number => Math.floor(this.position_m[3 * i + axis]! / size) + 512;
    return (cell(0) * 1024 + cell(1)) * 1024 + cell(2);
  }

  private pushApart(): void {
    this.cells.clear();
    for (let i = 0; i < this.count; ++i) {
      const key = this.cellOf(i);
      const list = this.cells.get(key);
      if (list) list.push(i);
      else this.cells.set(key, [i]);
    }
    for (const [key, list] of this.cells)
      for (let offset = 0; offset < 27; ++offset) {
        const other =
          key + ((Math.floor(offset / 9) - 1) * 1024 + ((Math.floor(offset / 3) % 3) - 1)) * 1024 + ((offset % 3) - 1);
        if (other < key) continue;
        const neighbours = this.cells.get(other);
        if (neighbours)
          for (const a of list) for (const b of neighbours) if (other !== key || b > a) this.pushPair(a, b);
      }
    const wall = this.width_m / 2 - this.radius_m;
    for (let i = 0; i < this.count; ++i) {
      for (const axis of [0, 1])
        this.position_m[3 * i + axis] = Math.min(wall, Math.max(-wall, this.position_m[3 * i + axis]!));
      this.position_m[3 * i + 2] = Math.max(this.radius_m, this.position_m[3 * i + 2]!);
    }
  }

  private pushPair(a: number, b: number): void {
    const p = this.position_m;
    const dx = p[3 * b]! - p[3 * a]!;
    const dy = p[3 * b + 1]! - p[3 * a + 1]!;
    const dz = p[3 * b + 2]! - p[3 * a + 2]!;
    const square = dx * dx + dy * dy + dz * dz;
    const touch = 1.9 * this.radius_m;
    if (square >= touch * touch || square === 0) return;
    const gap = Math.sqrt(square);
    const by = (0.35 * (touch - gap)) / gap;
    p[3 * a]! -= dx * by;
    p[3 * a + 1]! -= dy * by;
    p[3 * a + 2]! -= dz * by;
    p[3 * b]! += dx * by;
    p[3 * b + 1]! += dy * by;
    p[3 * b + 2]! += dz * by;
    const force_n = 4 * (touch - gap);
    this.force_n[a]! += force_n;
    this.force_n[b]! += force_n;
  }
}

function halfSize(tool: Tool): Vec3 {
  const shape = shapeOf(tool);
  const [x, y, z] = shape.half_m(tool);
  if (shape.jaws) return [tool.opening_mm / 2000 + 2 * x, y, z];
  // Round tools count as a box of about their size.
  const across = { box: 1, cylinder: 0.8, sphere: 0.58, none: 1 }[shape.solid];
  return [across * x, across * y, shape.solid === 'sphere' ? across * z : z];
}

function rotate([w, x, y, z]: Pose['rotation'], v: Vec3): Vec3 {
  const tx = 2 * (y * v[2] - z * v[1]);
  const ty = 2 * (z * v[0] - x * v[2]);
  const tz = 2 * (x * v[1] - y * v[0]);
  return [v[0] + w * tx + y * tz - z * ty, v[1] + w * ty + z * tx - x * tz, v[2] + w * tz + x * ty - y * tx];
}
