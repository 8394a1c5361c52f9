// Frame rate in software rendering, because the loop that computes the soil also needs the processor. With a graphics
// card every frame of the screen is drawn.

const SCREEN_MS = 1000 / 60;
const SOFTWARE_MS = 1000 / 12;
const LATE_LOOP_MS = 1000 / 6;
const LATE_SHARE = 0.004;
const WINDOW_TICKS = 2000;
const CALM_TICKS = 10_000;

export class Pace {
  interval_ms: number;
  private next_ms = -Infinity;
  private from: { ticks: number; misses: number } | null = null;
  private calm_ticks = 0;

  constructor(private readonly software: boolean) {
    this.interval_ms = software ? SOFTWARE_MS : SCREEN_MS;
  }

  /** Whether the next frame may be drawn. */
  due(now_ms: number): boolean {
    return !this.software || now_ms >= this.next_ms;
  }

  drawn(now_ms: number): void {
    // Screens refresh in steps: half a step early is better than half a step late.
    this.next_ms = now_ms + this.interval_ms - SCREEN_MS / 2;
  }

  /** Evaluates the loop's ticks and missed deadlines so far: the frame rate is reduced while it is late. */
  watchLoop(ticks: number, misses: number): void {
    if (!this.software) return;
    if (this.from === null || ticks < this.from.ticks) this.from = { ticks, misses };
    const passed = ticks - this.from.ticks;
    if (passed < WINDOW_TICKS) return;
    const late = misses - this.from.misses > LATE_SHARE * passed;
    this.calm_ticks = late ? 0 : this.calm_ticks + passed;
    this.from = { ticks, misses };
    if (late) this.interval_ms = LATE_LOOP_MS;
    else if (this.calm_ticks >= CALM_TICKS) this.interval_ms = SOFTWARE_MS;
  }
}
