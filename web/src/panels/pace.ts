// Timing of the loop: one word for the last ten seconds, and the numbers behind it.

import type { Status } from 'haptolith-protocol';

export const SPAN_S = 10;
// A late loop is reported sooner than one that is in time.
const LATE_AFTER_S = 2;
const TICKS_PER_S = 1000;
const IN_TIME = 0.99;
const FULL_RATE = 0.97;

/** Missed ticks by cause: the tick took too long, the loop was woken late, or its thread was preempted. */
export interface Causes {
  too_long: number;
  woken_late: number;
  preempted: number;
}

export interface Pace {
  /** `measuring`: fewer than ten seconds are known */
  kind: 'measuring' | 'in time' | 'late' | 'paused' | 'slow motion';
  /** late because other programs take the processor, not because of the soil */
  others: boolean;
  /** ticks and missed ticks of the last ten seconds */
  ticks: number;
  misses: number;
  /** null: not reported by the program */
  causes: Causes | null;
}

interface Sample {
  at_ms: number;
  ticks: number;
  misses: number;
  rate_hz: number;
  causes: Causes | null;
}

function sampleOf(status: Status, at_ms: number): Sample {
  const { ticks, misses, rate_hz, misses_too_long, misses_woken_late, misses_preempted } = status;
  const causes =
    misses_too_long === undefined
      ? null
      : { too_long: misses_too_long, woken_late: misses_woken_late ?? 0, preempted: misses_preempted ?? 0 };
  return { at_ms, ticks, misses, rate_hz, causes };
}

export class PaceWatch {
  private samples: Sample[] = [];

  /** Drops older samples, which do not apply to another bed or program. */
  clear(): void {
    this.samples = [];
  }

  add(status: Status, now_ms: number): Pace {
    const sample = sampleOf(status, now_ms);
    const last = this.samples.at(-1);
    if (status.paused || status.speed !== 1 || (last && sample.ticks < last.ticks)) this.clear();
    this.samples.push(sample);
    // The last sample that is old enough is kept: the span begins with it.
    while (this.samples.length > 1 && now_ms - this.samples[1]!.at_ms >= 1000 * SPAN_S) this.samples.shift();
    return this.paceOf(status);
  }

  private paceOf(status: Status): Pace {
    const [first, last] = [this.samples[0]!, this.samples.at(-1)!];
    const ticks = last.ticks - first.ticks;
    const misses = last.misses - first.misses;
    const causes = last.causes &&
      first.causes && {
        too_long: last.causes.too_long - first.causes.too_long,
        woken_late: last.causes.woken_late - first.causes.woken_late,
        preempted: last.causes.preempted - first.causes.preempted,
      };
    const others = causes !== null && causes.woken_late + causes.preempted > causes.too_long;
    const numbers = { others, ticks, misses, causes };
    if (status.paused) return { kind: 'paused', ...numbers };
    if (status.speed !== 1) return { kind: 'slow motion', ...numbers };
    const known_s = (last.at_ms - first.at_ms) / 1000;
    const rates = this.samples.slice(1).map(({ rate_hz }) => rate_hz);
    const rate_hz = rates.reduce((sum, rate) => sum + rate, 0) / Math.max(1, rates.length);
    const late = misses > (1 - IN_TIME) * ticks || rate_hz < FULL_RATE * TICKS_PER_S;
    if (known_s >= LATE_AFTER_S && late) return { kind: 'late', ...numbers };
    return { kind: known_s >= SPAN_S ? 'in time' : 'measuring', ...numbers };
  }
}

/** Returns the one word (or two) of the strip. */
export function paceInBrief({ kind, others }: Pace, can_coarsen: boolean): string {
  if (kind !== 'late') return kind;
  return others ? 'late: other programs' : can_coarsen ? 'late: coarser soil?' : 'late';
}

/** Returns a sentence that explains the word, and a remedy. */
export function paceInWords({ kind, others }: Pace, can_coarsen: boolean): string {
  switch (kind) {
    case 'measuring':
      return 'Measuring the force loop; the result is available after ten seconds.';
    case 'in time':
      return 'At least 99 % of the ticks of the last ten seconds finished within 1 ms.';
    case 'paused':
      return 'The simulation is paused.';
    case 'slow motion':
      return 'Simulated time is slower, so ticks have more time.';
    case 'late': {
      const offer = can_coarsen ? ' Coarser particles need less CPU time.' : '';
      return others
        ? `Other programs delay the force loop. Close some of them.${offer}`
        : `The particles are too small for this machine: ticks take longer than 1 ms.${offer}`;
    }
  }
}

/** Formats missed ticks: "12 of 10000: 3 too long, 7 woken late, 2 preempted". */
export function missesInWords({ ticks, misses, causes }: Pace): string {
  const told = causes
    ? `: ${causes.too_long} too long, ${causes.woken_late} woken late, ${causes.preempted} preempted`
    : '';
  return `${misses} of ${ticks}${misses > 0 ? told : ''}`;
}
