// An axis: conversion from values to pixels, and positions of its marks.

export interface Scale {
  px(value: number): number;
  ticks: number[];
}

const STEPS = [1, 2, 2.5, 5, 10];
const DECADE = [1, 2, 5];

/** Returns marks at round values from low to high, about `wanted` of them. */
export function linearTicks(low: number, high: number, wanted: number): number[] {
  if (!(high > low)) return [low];
  const rough = (high - low) / wanted;
  const decade = 10 ** Math.floor(Math.log10(rough));
  const step = STEPS.map((factor) => factor * decade).find((candidate) => candidate >= rough * 0.999) ?? 10 * decade;
  const ticks: number[] = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) ticks.push(round(i * step));
  return ticks;
}

/** Returns marks at 1, 2 and 5 of each decade; at even steps where that would be too few. */
export function logTicks(low: number, high: number): number[] {
  const ticks: number[] = [];
  for (let decade = Math.floor(Math.log10(low)); decade <= Math.log10(high); ++decade)
    ticks.push(...DECADE.map((factor) => round(factor * 10 ** decade)));
  const within = ticks.filter((tick) => tick >= low && tick <= high);
  return within.length >= 3 ? within : linearTicks(low, high, 4);
}

export function makeScale(low: number, high: number, from_px: number, to_px: number, log: boolean): Scale {
  const bend = (value: number): number => (log ? Math.log(value) : value);
  const span = bend(high) - bend(low) || 1;
  return {
    px: (value) => from_px + ((bend(value) - bend(low)) / span) * (to_px - from_px),
    ticks: log ? logTicks(low, high) : linearTicks(low, high, 5),
  };
}

const round = (value: number): number => Number(value.toPrecision(12));
