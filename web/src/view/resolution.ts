// Fewer pixels when frames are slow, more when there is time: grains that follow the hand matter more than sharp ones.

const LOWEST_RATIO = 0.4;
const SAMPLES = 20;
const SLOW_MS = 30;
const QUICK_MS = 14;

export class Resolution {
  private readonly deltas_ms: number[] = [];
  private last_ms: number | null = null;
  private quick_rounds = 0;
  ratio: number;
  /** false on machines that need the cheaper way to draw */
  detailed: boolean;

  constructor(
    private readonly highest_ratio: number,
    private readonly adaptive: boolean,
    slow: boolean,
  ) {
    this.ratio = slow ? Math.max(LOWEST_RATIO, 0.6 * highest_ratio) : highest_ratio;
    this.detailed = !slow;
  }

  /** The picture stood still; the next pause between two frames says nothing about speed. */
  rest(): void {
    this.last_ms = null;
  }

  /** Called once for every frame drawn; true when `ratio` or `detailed` changed. */
  drawn(now_ms: number): boolean {
    if (!this.adaptive) return false;
    if (this.last_ms !== null) this.deltas_ms.push(now_ms - this.last_ms);
    this.last_ms = now_ms;
    if (this.deltas_ms.length < SAMPLES) return false;
    this.deltas_ms.sort((a, b) => a - b);
    const median_ms = this.deltas_ms[SAMPLES >> 1]!;
    this.deltas_ms.length = 0;
    return this.judge(median_ms);
  }

  private judge(median_ms: number): boolean {
    if (median_ms > SLOW_MS) {
      this.quick_rounds = 0;
      if (this.ratio > Math.max(0.7, LOWEST_RATIO)) return this.set(this.ratio * 0.8, this.detailed);
      if (this.detailed) return this.set(this.ratio, false);
      return this.set(this.ratio * 0.85, false);
    }
    // Going up needs several quick rounds, so that the picture does not swing between two resolutions.
    this.quick_rounds = median_ms < QUICK_MS + 4 ? this.quick_rounds + 1 : 0;
    if (this.quick_rounds < 12) return false;
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
