// Colour scale of the particles, and a length scale of the picture.

import type { ColourMode } from 'haptolith-protocol';
import { ASLEEP_COLOUR, AWAKE_COLOUR, niceStep, scaleOf, VIRIDIS } from '../view/colour_maps';
import { h, setText } from './html';

const LONGEST_BAR_PX = 130;

export class Legend {
  readonly element = h('div', { class: 'legend', 'aria-live': 'off' });
  private shown = '';

  show(mode: ColourMode, depth_range_m: number): void {
    const wanted = `${mode} ${mode === 'depth' ? depth_range_m : ''}`;
    if (wanted === this.shown) return;
    this.shown = wanted;
    this.element.replaceChildren(...this.content(mode, depth_range_m));
    this.element.hidden = mode === 'plain';
  }

  private content(mode: ColourMode, depth_range_m: number): HTMLElement[] {
    if (mode === 'plain') return [];
    if (mode === 'sleep') {
      const entry = (colour: string, name: string): HTMLElement =>
        h('span', { class: 'legend-entry' }, h('i', { class: 'dot', style: `background:${colour}` }), name);
      return [h('div', { class: 'legend-keys' }, entry(AWAKE_COLOUR, 'awake'), entry(ASLEEP_COLOUR, 'asleep'))];
    }
    const scale = scaleOf(mode, depth_range_m)!;
    // Depth reads from left to right like the others: the surface is bright, at the left.
    const reversed = mode === 'depth';
    const colours = reversed ? [...VIRIDIS].reverse() : VIRIDIS;
    const ticks = scale.ticks.map(({ at, label }) =>
      h('span', { class: 'legend-tick', style: `left:${100 * (reversed ? 1 - at : at)}%` }, label),
    );
    return [
      h('div', { class: 'legend-title' }, `${scale.title}, ${scale.unit}`),
      h('div', { class: 'legend-bar', style: `background:linear-gradient(to right,${colours.join(',')})` }),
      h('div', { class: 'legend-ticks numbers' }, ...ticks),
    ];
  }
}

export class ScaleBar {
  readonly element: HTMLElement;
  private readonly bar = h('i', { class: 'scale-line' });
  private readonly label = h('span', { class: 'numbers' });
  private shown = '';

  constructor() {
    this.element = h('div', { class: 'scale-bar', title: 'at the centre of the bed' }, this.label, this.bar);
  }

  show(metres_per_px: number): void {
    let mm = niceStep(LONGEST_BAR_PX * metres_per_px * 1000 * 0.999);
    if (mm / 1000 / metres_per_px > LONGEST_BAR_PX) mm = niceStep(mm / 2.6);
    const px = Math.round(mm / 1000 / metres_per_px);
    const wanted = `${mm} ${px}`;
    if (wanted === this.shown) return;
    this.shown = wanted;
    this.bar.style.width = `${px}px`;
    setText(this.label, mm >= 1000 ? `${mm / 1000} m` : `${mm} mm`);
  }
}
