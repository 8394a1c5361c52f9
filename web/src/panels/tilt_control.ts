// The tilt of the tool over the picture: a slider with a button at each end, for mouse and fingers.

import { HIGHEST_TILT_DEG, LOWEST_TILT_DEG } from '../hand/tilt';
import { EXPLAIN } from './explanations';
import { h, setText } from './html';
import { explain } from './tooltip';

const STEP_DEG = 10;
const INTERVAL_MS = 150;

export class TiltControl {
  readonly element: HTMLElement;
  private readonly slider = h('input', {
    type: 'range',
    min: LOWEST_TILT_DEG,
    max: HIGHEST_TILT_DEG,
    step: 5,
    value: 0,
    'aria-label': 'Tilt of the tool in degrees, nose down',
  });
  private readonly value = h('output', { class: 'numbers' }, '–');
  private readonly buttons: HTMLButtonElement[];
  private shown_ms = -Infinity;
  private sliding_until_ms = -Infinity;

  /** @param set  requests a tilt, in degrees; false: currently not possible. */
  constructor(private readonly set: (tilt_deg: number) => boolean) {
    this.buttons = [this.button('−', 'Nose up (S)', -STEP_DEG), this.button('+', 'Nose down (W)', STEP_DEG)];
    this.slider.addEventListener('input', () => this.ask(this.slider.valueAsNumber));
    this.element = h(
      'div',
      { class: 'tilt', role: 'group', 'aria-label': 'Tilt of the tool' },
      h('span', { class: 'tilt-name' }, 'Tilt'),
      this.buttons[0]!,
      this.slider,
      this.buttons[1]!,
      this.value,
      h('span', { class: 'tilt-keys', 'aria-hidden': 'true' }, h('kbd', {}, 'S'), ' ', h('kbd', {}, 'W')),
    );
    explain(this.slider, EXPLAIN.tilt);
  }

  /** Shows a tilt; null: not known. A few times a second, because digits that change faster cannot be read. */
  show(tilt_deg: number | null, now_ms: number): void {
    if (now_ms - this.shown_ms < INTERVAL_MS) return;
    this.shown_ms = now_ms;
    for (const control of [this.slider, ...this.buttons]) control.disabled = tilt_deg === null;
    if (tilt_deg === null || now_ms < this.sliding_until_ms) return;
    // A slider that the user is dragging keeps its position.
    this.slider.value = String(tilt_deg);
    setText(this.value, `${Math.round(tilt_deg)}°`.replace('-', '\u2212'));
  }

  private button(sign: string, label: string, by_deg: number): HTMLButtonElement {
    return h(
      'button',
      {
        type: 'button',
        class: 'icon-button',
        'aria-label': label,
        title: label,
        onclick: () => this.ask(this.slider.valueAsNumber + by_deg),
      },
      sign,
    );
  }

  private ask(wished_deg: number): void {
    const tilt_deg = Math.max(LOWEST_TILT_DEG, Math.min(HIGHEST_TILT_DEG, wished_deg));
    if (!this.set(tilt_deg)) return;
    this.slider.value = String(tilt_deg);
    setText(this.value, `${tilt_deg}°`.replace('-', '\u2212'));
    this.sliding_until_ms = performance.now() + 300;
  }
}
