// Colour maps for numbers. Viridis is perceptually uniform and safe for colour-blind users; linear interpolation
// between nine samples is within a just noticeable difference of the published table.

import type { ColourMode } from 'haptolith-protocol';

export const VIRIDIS = [
  '#440154',
  '#472d7b',
  '#3b528b',
  '#2c728e',
  '#21918c',
  '#28ae80',
  '#5ec962',
  '#addc30',
  '#fde725',
] as const;

export const ASLEEP_COLOUR = '#3f5f8a';
export const AWAKE_COLOUR = '#f2b134';

export interface Tick {
  /** 0 at the low end of the colours, 1 at the high end */
  at: number;
  label: string;
}

export interface Scale {
  title: string;
  unit: string;
  ticks: Tick[];
}

/** Range of the force colours, in N: contact forces of single particles of these beds. */
export const FORCE_RANGE_N = { low: 1e-4, high: 10 } as const;
export const SPEED_RANGE_M_S = { low: 1e-4, high: 1 } as const;

function decades(low: number, high: number, labels: Record<string, string>): Tick[] {
  const span = Math.log10(high / low);
  return Object.entries(labels).map(([value, label]) => ({ at: Math.log10(Number(value) / low) / span, label }));
}

/** Returns the legend of a colour mode; null where colours do not represent a number. */
export function scaleOf(mode: ColourMode, depth_range_m: number): Scale | null {
  switch (mode) {
    case 'force':
      return {
        title: 'contact force of a grain',
        unit: 'N',
        ticks: decades(FORCE_RANGE_N.low, FORCE_RANGE_N.high, {
          '1e-4': '0.0001',
          '1e-3': '0.001',
          '1e-2': '0.01',
          '1e-1': '0.1',
          '1': '1',
          '10': '10',
        }),
      };
    case 'speed':
      return {
        title: 'speed',
        unit: 'mm/s',
        ticks: decades(SPEED_RANGE_M_S.low, SPEED_RANGE_M_S.high, {
          '1e-4': '0.1',
          '1e-3': '1',
          '1e-2': '10',
          '1e-1': '100',
          '1': '1000',
        }),
      };
    case 'depth': {
      const ticks: Tick[] = [];
      const step_mm = niceStep((depth_range_m * 1000) / 5);
      for (let mm = 0; mm <= depth_range_m * 1000 * 1.001; mm += step_mm)
        ticks.push({ at: 1 - mm / (depth_range_m * 1000), label: `${mm}` });
      return { title: 'depth below the level surface', unit: 'mm', ticks };
    }
    default:
      return null;
  }
}

/** Returns the smallest of 1, 2, 5, 10, ... that is at least `value`. */
export function niceStep(value: number): number {
  const decade = 10 ** Math.floor(Math.log10(value));
  for (const factor of [1, 2, 5, 10]) if (factor * decade >= value * 0.999) return factor * decade;
  return 10 * decade;
}
