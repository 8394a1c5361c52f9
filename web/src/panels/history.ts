// Values over time for a plot: the last ten seconds of simulated time.

export const SPAN_S = 10;
// Frames come at most 62 times a second; capacity for slightly more than the span, and for gaps.
const CAPACITY = 800;
// An interruption of the page or the network leaves a gap without a line; animation files have a frame every 0.1 s.
const GAP_S = 0.12;

/** Times relative to the newest value, in s (negative), and the values of each column; null: no value. */
export type Table = [number[], ...(number | null)[][]];

export class History {
  private readonly times_s = new Float64Array(CAPACITY);
  private readonly columns: Float32Array[];
  private next = 0;
  private count = 0;
  private last_s = -Infinity;

  constructor(columns: number) {
    this.columns = Array.from({ length: columns }, () => new Float32Array(CAPACITY));
  }

  /** Appends values; a NaN is a gap in its column. */
  add(time_s: number, values: readonly number[]): void {
    // Time went back: another scene, or an undo.
    if (time_s < this.last_s) this.count = 0;
    if (time_s === this.last_s) return;
    if (this.count > 0 && time_s - this.last_s > GAP_S) this.push((this.last_s + time_s) / 2, []);
    this.push(time_s, values);
    this.last_s = time_s;
  }

  table(): Table {
    const x: number[] = [];
    const ys: (number | null)[][] = this.columns.map(() => []);
    for (let i = 0; i < this.count; ++i) {
      const at = (this.next - this.count + i + CAPACITY) % CAPACITY;
      const before_s = this.times_s[at]! - this.last_s;
      if (before_s < -SPAN_S) continue;
      x.push(before_s);
      ys.forEach((y, column) => {
        const value = this.columns[column]![at]!;
        y.push(Number.isNaN(value) ? null : value);
      });
    }
    return [x, ...ys];
  }

  private push(time_s: number, values: readonly number[]): void {
    this.times_s[this.next] = time_s;
    this.columns.forEach((column, i) => (column[this.next] = values[i] ?? NaN));
    this.next = (this.next + 1) % CAPACITY;
    this.count = Math.min(CAPACITY, this.count + 1);
  }
}

/** Returns the indices of values with a gap on both sides, which a line does not show. */
export function lonely(values: ArrayLike<number | null | undefined>): number[] {
  const found: number[] = [];
  for (let i = 0; i < values.length; ++i)
    if (values[i] != null && values[i - 1] == null && values[i + 1] == null) found.push(i);
  return found;
}
