// A countdown in seconds between the program's messages.

export class Countdown {
  private left_s: number | null = null;
  private longest_s = 0;
  private set_ms = 0;

  constructor(private readonly now_ms: () => number = () => performance.now()) {}

  /** Starts another time limit; null: no limit. */
  begin(remaining_s: number | null): void {
    this.longest_s = 0;
    this.set(remaining_s);
  }

  /** Sets the remaining time that the program reports. */
  set(remaining_s: number | null): void {
    this.left_s = remaining_s;
    this.set_ms = this.now_ms();
    this.longest_s = Math.max(this.longest_s, remaining_s ?? 0);
  }

  get remaining_s(): number | null {
    return this.left_s === null ? null : Math.max(0, this.left_s - (this.now_ms() - this.set_ms) / 1000);
  }

  /** Fraction of the total time that is left, 0 to 1. */
  get share(): number {
    return this.longest_s > 0 ? (this.remaining_s ?? 0) / this.longest_s : 0;
  }
}

/** Formats whole seconds, rounded up: "12 s", "1:05". */
export function clockText(seconds: number): string {
  const whole = Math.ceil(seconds);
  return whole < 60 ? `${whole} s` : `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
}
