// The soil as one surface: what a bed of far finer grains would look like from above. Macroparticles stand for soil, so
// their round tops are not shown: gaps between them are filled and bumps smoothed, and the ground around the box takes
// the bed up at its own level. Beside the height, the shaders learn how high the shadow of the sun reaches over each
// point and how far the soil there has come since the scene began, so that what they draw on it moves with it.
//
// What the tool carries or throws lies above the surface and is no part of it: it is listed, as are the particles that
// can be seen, for fine_grains.ts to draw.

import { DataTexture, DataUtils, HalfFloatType, LinearFilter, RGBAFormat, RGFormat, Vector4 } from 'three';
import { dequantise, type Scene } from '../protocol';
import { MOST_FLYING, type Carrier } from './height_field';
import { ballAround, boxBlur, HeightOrder, raiseTriangles, type Grid } from './height_grid';

const LARGEST_SIDE = 192;
const CELLS_PER_RADIUS = 3;
// How steeply the ground around the box goes up or down to a heap or a pit at its edge.
const EDGE_SLOPE = 0.6;
const MARGIN_RADII = 6;
// With a gap between these below its lowest point, a particle lies less and less on the bed.
const LYING_RADII = 0.3;
const ALOFT_RADII = 1.5;
// Particles whose top is farther below the surface than this are not seen.
const SEEN_RADII = 1.6;
// Particles nearer than this to each other are in one heap; more than so many are not looked at.
const HEAP_RADII = 5;
const MOST_IN_HEAPS = 400;

export class SoilSurface implements Grid {
  readonly columns: number;
  readonly rows: number;
  readonly low_x_m: number;
  readonly low_y_m: number;
  readonly width_m: number;
  readonly length_m: number;
  readonly cell_width_m: number;
  readonly cell_length_m: number;
  /** height of the surface, of the shadow over it, and how far the soil has come along x and y, all in m */
  readonly texture: DataTexture;
  /** height of all that stands there, and smoothed; as HeightField has it */
  readonly standing: DataTexture;
  top_m = 0;
  /** height of the ground around, in m */
  level_m: number;
  /** centres and radii of balls about what is aloft; the first `flying_count` are valid */
  readonly flying_m = Array.from({ length: MOST_FLYING }, () => new Vector4());
  flying_count = 0;
  /** towards the outside of the heap in which a particle is aloft, x, y, z; 0 for those on the bed and for single ones */
  readonly outwards: Float32Array;
  /** particles that can be seen; the first `seen_count` are valid */
  readonly seen: Uint32Array;
  seen_count = 0;

  /** the particle at the top of each cell */
  readonly topmost: Uint32Array;

  private readonly bed: Float32Array;
  private readonly surface: Float32Array;
  private readonly shadow: Float32Array;
  private readonly scratch: Float32Array;
  private readonly wide: Float32Array;
  private readonly drift_x: Float32Array;
  private readonly drift_y: Float32Array;
  private readonly halves: Uint16Array;
  private readonly standing_halves: Uint16Array;
  private readonly order = new HeightOrder();
  /** where each particle was first, x and y */
  private readonly from_m: Float32Array;
  private from_known = false;
  private readonly aloft: number[] = [];
  private readonly aloft_particles: number[] = [];

  constructor(
    private readonly scene: Scene,
    private readonly radii_m: Float32Array,
    private readonly to_sun: { x: number; y: number; z: number },
  ) {
    const finest_m = radii_m.reduce((least, radius_m) => Math.min(least, radius_m), scene.radius_m);
    const margin_m = MARGIN_RADII * scene.radius_m;
    this.level_m = scene.box.surface_m;
    this.width_m = scene.box.width_m + 2 * margin_m;
    this.length_m = scene.box.length_m + 2 * margin_m;
    this.low_x_m = -this.width_m / 2;
    this.low_y_m = -this.length_m / 2;
    const cell_m = Math.max(Math.max(this.width_m, this.length_m) / LARGEST_SIDE, finest_m / CELLS_PER_RADIUS);
    this.columns = Math.max(8, Math.ceil(this.width_m / cell_m));
    this.rows = Math.max(8, Math.ceil(this.length_m / cell_m));
    this.cell_width_m = this.width_m / this.columns;
    this.cell_length_m = this.length_m / this.rows;
    const cells = this.columns * this.rows;
    const heights = (): Float32Array => new Float32Array(cells);
    [this.bed, this.surface, this.shadow, this.scratch, this.wide] = [
      heights(),
      heights(),
      heights(),
      heights(),
      heights(),
    ];
    [this.drift_x, this.drift_y] = [heights(), heights()];
    this.topmost = new Uint32Array(cells);
    this.outwards = new Float32Array(3 * radii_m.length);
    this.seen = new Uint32Array(radii_m.length);
    this.from_m = new Float32Array(2 * radii_m.length);
    this.halves = new Uint16Array(4 * cells);
    this.standing_halves = new Uint16Array(2 * cells);
    this.texture = new DataTexture(this.halves, this.columns, this.rows, RGBAFormat, HalfFloatType);
    this.standing = new DataTexture(this.standing_halves, this.columns, this.rows, RGFormat, HalfFloatType);
    for (const texture of [this.texture, this.standing]) texture.magFilter = texture.minFilter = LinearFilter;
  }

  /** As HeightField.build; `thickness_m`: of the tool, whose thickness between soil and soil is no gap. */
  build(
    records: Uint16Array,
    particles: number,
    carrier: (Carrier & { thickness_m: number }) | null = null,
    stones_m: readonly Float32Array[] = [],
  ): void {
    const first = !this.from_known;
    if (first) this.rememberPlaces(records, particles);
    this.order.sort(records, particles);
    this.lay(records, particles, carrier);
    this.extend();
    this.fillGaps();
    this.blurTwice(this.bed, this.surface, 0.55);
    if (first) this.findLevel();
    this.meetGround();
    this.blurTwice(this.drift_x, this.drift_x, 0.6);
    this.blurTwice(this.drift_y, this.drift_y, 0.6);
    this.blurTwice(this.surface, this.wide, 1.6);
    this.findSeen(records, particles);
    // From here on, `bed` is what stands there, stones too.
    this.bed.set(this.surface);
    this.groupAloft();
    this.findOutwards();
    for (const triangles_m of stones_m) this.layStone(triangles_m);
    this.castShadows();
    this.upload();
  }

  /** Height of the surface at a point, in m; the level ground beside the field. */
  heightAt(x_m: number, y_m: number): number {
    const column = Math.floor((x_m - this.low_x_m) / this.cell_width_m);
    const row = Math.floor((y_m - this.low_y_m) / this.cell_length_m);
    if (column < 0 || row < 0 || column >= this.columns || row >= this.rows) return this.level_m;
    return this.surface[row * this.columns + column]!;
  }

  /** Whether the sun does not reach the surface at a point. */
  isShaded(x_m: number, y_m: number): boolean {
    const column = Math.floor((x_m - this.low_x_m) / this.cell_width_m);
    const row = Math.floor((y_m - this.low_y_m) / this.cell_length_m);
    const at = row * this.columns + column;
    return this.shadow[at]! > this.surface[at]!;
  }

  dispose(): void {
    this.texture.dispose();
    this.standing.dispose();
  }

  private rememberPlaces(records: Uint16Array, particles: number): void {
    const { low_m, high_m } = this.scene.quantised;
    for (let i = 0; i < particles; ++i) {
      this.from_m[2 * i] = dequantise(records[4 * i]!, low_m[0], high_m[0]);
      this.from_m[2 * i + 1] = dequantise(records[4 * i + 1]!, low_m[1], high_m[1]);
    }
    this.from_known = true;
  }

  /** Lays the round tops of the particles over each other; lists those under which there is nothing. */
  private lay(records: Uint16Array, particles: number, carrier: (Carrier & { thickness_m: number }) | null): void {
    const { bed, drift_x, drift_y, columns, rows, low_x_m, low_y_m, cell_width_m: dx, cell_length_m: dy } = this;
    const { low_m, high_m } = this.scene.quantised;
    bed.fill(0);
    drift_x.fill(0);
    drift_y.fill(0);
    for (const i of this.aloft_particles) this.outwards.fill(0, 3 * i, 3 * i + 3);
    this.aloft.length = this.aloft_particles.length = 0;
    for (let nth = 0; nth < particles; ++nth) {
      const i = this.order.index[nth]!;
      const radius_m = this.radii_m[i]!;
      const x_m = dequantise(records[4 * i]!, low_m[0], high_m[0]);
      const y_m = dequantise(records[4 * i + 1]!, low_m[1], high_m[1]);
      const z_m = dequantise(records[4 * i + 2]!, low_m[2], high_m[2]);
      const lies = this.liesOnBed(x_m, y_m, z_m, radius_m, carrier);
      if (lies < 0.5) {
        this.aloft.push(x_m, y_m, z_m, radius_m);
        this.aloft_particles.push(i);
      }
      if (lies <= 0) continue;
      const x = x_m - low_x_m;
      const y = y_m - low_y_m;
      const first_column = Math.max(0, Math.ceil((x - radius_m) / dx - 0.5));
      const last_column = Math.min(columns - 1, Math.floor((x + radius_m) / dx - 0.5));
      const first_row = Math.max(0, Math.ceil((y - radius_m) / dy - 0.5));
      const last_row = Math.min(rows - 1, Math.floor((y + radius_m) / dy - 0.5));
      const drift_x_m = x_m - this.from_m[2 * i]!;
      const drift_y_m = y_m - this.from_m[2 * i + 1]!;
      for (let row = first_row; row <= last_row; ++row) {
        const off_y = (row + 0.5) * dy - y;
        const left = radius_m * radius_m - off_y * off_y;
        for (let column = first_column; column <= last_column; ++column) {
          const off_x = (column + 0.5) * dx - x;
          const rest = left - off_x * off_x;
          if (rest <= 0) continue;
          const at = row * columns + column;
          const rise_m = z_m + Math.sqrt(rest) - bed[at]!;
          if (rise_m <= 0) continue;
          bed[at]! += lies * rise_m;
          this.topmost[at] = i;
          drift_x[at] = drift_x_m;
          drift_y[at] = drift_y_m;
        }
      }
    }
  }

  /** 1 on the soil laid so far, 0 above it; between them, it leaves the bed without a jump. */
  private liesOnBed(
    x_m: number,
    y_m: number,
    z_m: number,
    radius_m: number,
    carrier: (Carrier & { thickness_m: number }) | null,
  ): number {
    let below_m = 0;
    for (let i = 0; i < 5; ++i) {
      const column = Math.floor((x_m + 0.7 * radius_m * PROBES[2 * i]! - this.low_x_m) / this.cell_width_m);
      const row = Math.floor((y_m + 0.7 * radius_m * PROBES[2 * i + 1]! - this.low_y_m) / this.cell_length_m);
      if (column < 0 || row < 0 || column >= this.columns || row >= this.rows) continue;
      below_m = Math.max(below_m, this.bed[row * this.columns + column]!);
    }
    let gap_m = z_m - radius_m - below_m;
    if (carrier) {
      const [x, y, z] = carrier.at_m;
      if (Math.hypot(x_m - x, y_m - y, z_m - z) < carrier.radius_m + radius_m) gap_m -= carrier.thickness_m;
    }
    const share = (gap_m / radius_m - LYING_RADII) / (ALOFT_RADII - LYING_RADII);
    const bounded = Math.min(1, Math.max(0, share));
    return 1 - bounded * bounded * (3 - 2 * bounded);
  }

  /** Carries the bed on where no centre of a particle can be: over the walls, and into the ground around. */
  private extend(): void {
    const inset_m = 0.8 * this.scene.radius_m;
    const { columns, rows } = this;
    const first_column = Math.ceil((-this.scene.box.width_m / 2 + inset_m - this.low_x_m) / this.cell_width_m);
    const first_row = Math.ceil((-this.scene.box.length_m / 2 + inset_m - this.low_y_m) / this.cell_length_m);
    const last_column = columns - 1 - first_column;
    const last_row = rows - 1 - first_row;
    for (const values of [this.bed, this.drift_x, this.drift_y, this.topmost])
      for (let row = 0; row < rows; ++row) {
        const from_row = Math.min(last_row, Math.max(first_row, row));
        for (let column = 0; column < columns; ++column) {
          const from_column = Math.min(last_column, Math.max(first_column, column));
          values[row * columns + column] = values[from_row * columns + from_column]!;
        }
      }
  }

  /** A ball as large as the particles, rolled over the bed, does not fall into what is narrower than itself. */
  private fillGaps(): void {
    const across = Math.max(1, Math.round((0.9 * this.scene.radius_m) / this.cell_width_m));
    const along = Math.max(1, Math.round((0.9 * this.scene.radius_m) / this.cell_length_m));
    const { columns, rows, bed, scratch } = this;
    for (const pick of [Math.max, Math.min]) {
      for (let row = 0; row < rows; ++row) slide(pick, bed, scratch, row * columns, 1, columns, across);
      for (let column = 0; column < columns; ++column) slide(pick, scratch, bed, column, columns, rows, along);
    }
  }

  /** Two box blurs after each other, as wide as so many radii, are nearly a bell. */
  private blurTwice(from: Float32Array, to: Float32Array, radii: number): void {
    const { columns, rows, scratch } = this;
    const across = Math.max(1, Math.round((radii * this.scene.radius_m) / this.cell_width_m));
    const along = Math.max(1, Math.round((radii * this.scene.radius_m) / this.cell_length_m));
    for (let pass = 0; pass < 2; ++pass) {
      const source = pass === 0 ? from : to;
      for (let row = 0; row < rows; ++row) boxBlur(source, scratch, row * columns, 1, columns, across);
      for (let column = 0; column < columns; ++column) boxBlur(scratch, to, column, columns, rows, along);
    }
  }

  /** What is called the surface is where the tops of particles are, about; smoothed, they lie a little lower. */
  private findLevel(): void {
    const { columns, rows } = this;
    const inside = this.surface.filter((_, at) => {
      const across = Math.abs((at % columns) - columns / 2) * this.cell_width_m;
      const along = Math.abs(Math.floor(at / columns) - rows / 2) * this.cell_length_m;
      return across < 0.45 * this.scene.box.width_m && along < 0.45 * this.scene.box.length_m;
    });
    const median_m = inside.sort()[inside.length >> 1]!;
    if (Math.abs(median_m - this.level_m) < 2 * this.scene.radius_m) this.level_m = median_m;
  }

  /** Beside the box, heaps and pits run out into the level ground. */
  private meetGround(): void {
    const { columns, rows, surface } = this;
    const { width_m, length_m } = this.scene.box;
    const margin_m = MARGIN_RADII * this.scene.radius_m;
    for (let row = 0; row < rows; ++row) {
      const beyond_y_m = Math.abs(this.low_y_m + (row + 0.5) * this.cell_length_m) - length_m / 2;
      for (let column = 0; column < columns; ++column) {
        const beyond_x_m = Math.abs(this.low_x_m + (column + 0.5) * this.cell_width_m) - width_m / 2;
        const beyond_m = Math.hypot(Math.max(0, beyond_x_m), Math.max(0, beyond_y_m));
        if (beyond_m === 0) continue;
        const at = row * columns + column;
        const share = Math.min(1, beyond_m / (margin_m - 2 * this.cell_width_m));
        const above_m = surface[at]! - this.level_m;
        const left_m = Math.max(0, Math.abs(above_m) - EDGE_SLOPE * beyond_m) * (1 - share * share);
        surface[at] = this.level_m + Math.sign(above_m) * left_m;
        const kept = 1 - share * share * (3 - 2 * share);
        this.drift_x[at]! *= kept;
        this.drift_y[at]! *= kept;
      }
    }
  }

  private findSeen(records: Uint16Array, particles: number): void {
    const { low_m, high_m } = this.scene.quantised;
    this.seen_count = 0;
    for (let i = 0; i < particles; ++i) {
      const z_m = dequantise(records[4 * i + 2]!, low_m[2], high_m[2]);
      const x_m = dequantise(records[4 * i]!, low_m[0], high_m[0]);
      const y_m = dequantise(records[4 * i + 1]!, low_m[1], high_m[1]);
      if (z_m + SEEN_RADII * this.radii_m[i]! > this.heightAt(x_m, y_m)) this.seen[this.seen_count++] = i;
    }
  }

  /** Gathers what is aloft in a few balls, which cast its shadow. */
  private groupAloft(): void {
    const { aloft, flying_m } = this;
    const count = aloft.length / 4;
    const groups = Math.min(MOST_FLYING, count);
    const sums = new Float64Array(5 * groups);
    for (let i = 0; i < count; ++i) {
      const [x, y, z, r] = aloft.slice(4 * i, 4 * i + 4) as [number, number, number, number];
      let group = i;
      if (i >= groups) {
        let nearest = Infinity;
        for (let g = 0; g < groups; ++g) {
          const away = Math.hypot(x - aloft[4 * g]!, y - aloft[4 * g + 1]!, z - aloft[4 * g + 2]!);
          if (away < nearest) [nearest, group] = [away, g];
        }
      }
      for (const [k, value] of [x, y, z, r ** 3, 1].entries()) sums[5 * group + k]! += value;
    }
    this.flying_count = groups;
    for (let g = 0; g < groups; ++g) {
      const n = sums[5 * g + 4]!;
      // Balls that touch leave a third of the room free.
      const radius_m = Math.cbrt((n > 1 ? 1.5 : 1.2) * sums[5 * g + 3]!);
      flying_m[g]!.set(sums[5 * g]! / n, sums[5 * g + 1]! / n, sums[5 * g + 2]! / n, radius_m);
    }
  }

  /** Away from the neighbours of each: which way the side of a heap on the tool faces. */
  private findOutwards(): void {
    const { aloft, aloft_particles, outwards } = this;
    const count = Math.min(MOST_IN_HEAPS, aloft_particles.length);
    for (let a = 0; a < count; ++a)
      for (let b = 0; b < a; ++b) {
        const away = [0, 1, 2].map((axis) => aloft[4 * a + axis]! - aloft[4 * b + axis]!);
        const reach_m = HEAP_RADII * aloft[4 * a + 3]!;
        const squared = away[0]! ** 2 + away[1]! ** 2 + away[2]! ** 2;
        if (squared > reach_m * reach_m) continue;
        for (let axis = 0; axis < 3; ++axis) {
          outwards[3 * aloft_particles[a]! + axis]! += away[axis]! / reach_m;
          outwards[3 * aloft_particles[b]! + axis]! -= away[axis]! / reach_m;
        }
      }
  }

  /** Puts a stone on what is there, or lists it in place of the last ball when it flies. */
  private layStone(triangles_m: Float32Array): void {
    const ball = ballAround(triangles_m);
    if (ball.lowest_m - this.heightAt(ball.x_m, ball.y_m) <= this.scene.radius_m)
      return raiseTriangles(triangles_m, this.bed, this);
    this.flying_count = Math.min(MOST_FLYING, this.flying_count + 1);
    this.flying_m[this.flying_count - 1]!.set(ball.x_m, ball.y_m, ball.z_m, ball.radius_m);
  }

  /** Goes away from the sun, cell by cell: a shadow sinks with the way, and every top that stands above it begins anew. */
  private castShadows(): void {
    const { columns, rows, bed, shadow, to_sun, cell_width_m: dx, cell_length_m: dy } = this;
    const by_columns = Math.abs(to_sun.x) * dy >= Math.abs(to_sun.y) * dx;
    const [lines, cells] = by_columns ? [columns, rows] : [rows, columns];
    const [line_stride, cell_stride] = by_columns ? [1, columns] : [columns, 1];
    const [main, other] = by_columns ? [to_sun.x / dx, to_sun.y / dy] : [to_sun.y / dy, to_sun.x / dx];
    const towards = Math.sign(main);
    const aside = other / Math.abs(main);
    const drop_m = to_sun.z / Math.abs(main);
    const whole = Math.floor(aside);
    const part = aside - whole;
    for (let nth = 0; nth < lines; ++nth) {
      const line = towards > 0 ? lines - 1 - nth : nth;
      for (let cell = 0; cell < cells; ++cell) {
        const at = line * line_stride + cell * cell_stride;
        if (nth === 0) {
          shadow[at] = -1;
          continue;
        }
        const before = (line + towards) * line_stride;
        const a = before + Math.min(cells - 1, Math.max(0, cell + whole)) * cell_stride;
        const b = before + Math.min(cells - 1, Math.max(0, cell + whole + 1)) * cell_stride;
        const top_a = Math.max(shadow[a]!, bed[a]!);
        const top_b = Math.max(shadow[b]!, bed[b]!);
        shadow[at] = top_a + part * (top_b - top_a) - drop_m;
      }
    }
  }

  private upload(): void {
    const { surface, shadow, drift_x, drift_y, bed, wide, halves, standing_halves } = this;
    let top_m = 0;
    for (let i = 0; i < surface.length; ++i) {
      halves[4 * i] = DataUtils.toHalfFloat(surface[i]!);
      halves[4 * i + 1] = DataUtils.toHalfFloat(shadow[i]!);
      halves[4 * i + 2] = DataUtils.toHalfFloat(drift_x[i]!);
      halves[4 * i + 3] = DataUtils.toHalfFloat(drift_y[i]!);
      standing_halves[2 * i] = DataUtils.toHalfFloat(bed[i]!);
      standing_halves[2 * i + 1] = DataUtils.toHalfFloat(wide[i]!);
      if (bed[i]! > top_m) top_m = bed[i]!;
    }
    this.top_m = top_m;
    this.texture.needsUpdate = true;
    this.standing.needsUpdate = true;
  }
}

const PROBES = [0, 0, 1, 0, -1, 0, 0, 1, 0, -1];

/** Greatest or least of 2 reach + 1 neighbours along one line of a picture. */
function slide(
  pick: (a: number, b: number) => number,
  from: Float32Array,
  to: Float32Array,
  start: number,
  stride: number,
  count: number,
  reach: number,
): void {
  for (let i = 0; i < count; ++i) {
    let best = from[start + i * stride]!;
    const first = Math.max(0, i - reach);
    const last = Math.min(count - 1, i + reach);
    for (let k = first; k <= last; ++k) best = pick(best, from[start + k * stride]!);
    to[start + i * stride] = best;
  }
}
