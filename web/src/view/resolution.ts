// Lower resolution when frames are slow, higher when there is time: low latency matters more than sharp soil.

const LOWEST_RATIO = 0.4;
// In software rendering, more pixels would take time from the loop.
const SOFTWARE_RATIO = 0.6;
const SAMPLES = 20;
// Slow frames are judged by fewer samples, so that a judgement does not take a minute.
const FEWEST_SAMPLES = 3;
const LONGEST_LOOK_MS = 2000;
// Ratio of the actual to the intended interval between frames.
const SLOW = 1.8;
const QUICK = 1.08;
const QUICK_ROUNDS = 12;

export class Resolution {
  private readonly deltas_ms: number[] = [];
  private last_ms: number | null = null;
  private quick_rounds = 0;
  private highest_ratio: number;
  ratio: number;
  /** false on machines that need the cheaper way to draw */
  detailed: boolean;

  constructor(
    screen_ratio: number,
    private readonly adaptive: boolean,
    private readonly software: boolean,
  ) {
    this.highest_ratio = this.ratio = this.highestOf(screen_ratio);
    this.detailed = !software;
  }

  /** Sets another screen or zoom of the browser; a reduction of the resolution is kept. */
  setScreen(screen_ratio: number): void {
    const share = this.ratio / this.highest_ratio;
    this.highest_ratio = this.highestOf(screen_ratio);
    this.ratio = Math.max(Math.min(LOWEST_RATIO, this.highest_ratio), share * this.highest_ratio);
    this.deltas_ms.length = 0;
  }

  private highestOf(screen_ratio: number): number {
    return this.software ? Math.max(LOWEST_RATIO, SOFTWARE_RATIO * screen_ratio) : screen_ratio;
  }

  /** Drops the last time, because nothing was drawn for a while: the next interval is not valid. */
  rest(): void {
    this.last_ms = null;
  }

  /** Measures the interval. Called once for every frame drawn; true when `ratio` or `detailed` changed. */
  drawn(now_ms: number, wanted_ms = 1000 / 60): boolean {
    if (!this.adaptive) return false;
    if (this.last_ms !== null) this.deltas_ms.push(now_ms - this.last_ms);
    this.last_ms = now_ms;
    const count = this.deltas_ms.length;
    const looked_ms = this.deltas_ms.reduce((sum, delta_ms) => sum + delta_ms, 0);
    if (count < FEWEST_SAMPLES || (count < SAMPLES && looked_ms < LONGEST_LOOK_MS)) return false;
    this.deltas_ms.sort((a, b) => a - b);
    const median_ms = this.deltas_ms[count >> 1]!;
    this.deltas_ms.length = 0;
    return this.judge(median_ms / wanted_ms);
  }

  private judge(slowness: number): boolean {
    if (slowness > SLOW) {
      this.quick_rounds = 0;
      if (this.ratio > Math.max(0.7, LOWEST_RATIO)) return this.set(this.ratio * 0.8, this.detailed);
      if (this.detailed) return this.set(this.ratio, false);
      return this.set(this.ratio * 0.85, false);
    }
    // Increasing needs several quick rounds, so that the picture does not oscillate between two resolutions.
    this.quick_rounds = slowness < QUICK ? this.quick_rounds + 1 : 0;
    if (this.quick_rounds < QUICK_ROUNDS) return false;
    this.quick_rounds = 0;
    return this.set(this.ratio * 1.15, this.detailed);
  }

  private set(ratio: number, detailed: boolean): boolean {
    const bounded = Math.min(this.highest_ratio, Math.max(LOWEST_RATIO, ratio));
    const changed = bounded !== this.ratio || detailed !== this.detailed;
    this.ratio = bounded;
    this.detailed = detailed;
    return changed;
  }
}
