// A form: questions of a study about the participant and the task, one below the other.

import type { Field } from 'haptolith-protocol';
import { h } from '../panels/html';
import { words } from './words/words';

const MOST_BUTTONS = 11;
const MOST_PILLS = 7;
const SCALE_STEPS = 20;
const LONGEST_TEXT = 500;
// The program closes a connection that sends a message of more than 16384 bytes.
const MOST_BYTES = 16_000;

/** A field with its question and its response. */
interface Asked {
  element: HTMLElement;
  /** Returns the response; null: none yet. */
  answer(): string | null;
  /** Returns the reason why the response is invalid; null: valid. */
  fault(): string | null;
  focus(): void;
}

export class Form {
  readonly element = h('form', { class: 'form', novalidate: true, autocomplete: 'off' });
  private readonly asked: { field: Field; part: Asked; fault: HTMLElement }[];

  constructor(fields: readonly Field[], onFilled: (values: Record<string, string>) => void) {
    this.asked = fields.map((field, i) => {
      const part = ask(field, `field-${i}`);
      const fault = h('p', { class: 'fault', role: 'alert' });
      part.element.append(fault);
      part.element.addEventListener('input', () => fault.replaceChildren());
      return { field, part, fault };
    });
    this.element.append(...this.asked.map(({ part }) => part.element));
    this.element.addEventListener('submit', (event) => {
      event.preventDefault();
      if (this.showFaults()) onFilled(this.values());
    });
  }

  focus(): void {
    this.asked[0]?.part.focus();
  }

  /** Returns the given responses, by key. */
  values(): Record<string, string> {
    const given = this.asked.map(({ field, part }) => [field.key, part.answer()] as const);
    return Object.fromEntries(given.filter((entry): entry is [string, string] => entry[1] !== null));
  }

  /** Shows invalid responses; false when there are any. */
  private showFaults(): boolean {
    let first: Asked | null = null;
    for (const { field, part, fault } of this.asked) {
      const missing = field.required && part.answer() === null ? words().form.required : null;
      const text = part.fault() ?? missing;
      fault.textContent = text ?? '';
      if (text !== null) first ??= part;
    }
    first?.focus();
    return first === null;
  }
}

/** Whether a form is too long for one message. */
export function isTooLong(values: Record<string, string>): boolean {
  return new TextEncoder().encode(JSON.stringify(values)).length > MOST_BYTES;
}

function ask(field: Field, id: string): Asked {
  switch (field.kind) {
    case 'text':
    case 'number':
      return askWords(field, id);
    case 'yes-no':
      return askChoice(field, id, [
        ['yes', words().form.yes],
        ['no', words().form.no],
      ]);
    case 'choice': {
      const choices = field.choices.map((choice): [string, string] => [choice, choice]);
      return choices.length <= MOST_PILLS ? askChoice(field, id, choices) : askList(field, id);
    }
    case 'scale': {
      const steps = wholeSteps(field);
      return steps ? askChoice(field, id, steps, 'scale-buttons') : askSlider(field, id);
    }
  }
}

/** Returns the values of a scale that is short enough for a button each. */
export function wholeSteps({ low, high }: Field): [string, string][] | null {
  const count = high - low + 1;
  if (!Number.isInteger(low) || !Number.isInteger(high) || count < 2 || count > MOST_BUTTONS) return null;
  return Array.from({ length: count }, (_, i) => [String(low + i), String(low + i)]);
}

/** Returns the distance of the marks of a long scale: 5 on NASA-TLX's, from 0 to 100. */
export function scaleStep({ low, high }: Field): number {
  return (high - low) / SCALE_STEPS;
}

function labelled(field: Field, id: string, input: HTMLElement): HTMLElement {
  return h('div', { class: 'asked' }, h('label', { for: id }, field.label, optional(field)), input);
}

function optional(field: Field): HTMLElement | null {
  return field.required ? null : h('small', { class: 'optional' }, words().form.optional);
}

function askWords(field: Field, id: string): Asked {
  const is_number = field.kind === 'number';
  const bounded = is_number && field.high > field.low;
  const input = h('input', {
    id,
    type: is_number ? 'number' : 'text',
    class: is_number ? 'short' : null,
    step: is_number ? 'any' : null,
    min: bounded ? field.low : null,
    max: bounded ? field.high : null,
    maxlength: is_number ? null : LONGEST_TEXT,
    'aria-required': String(field.required),
  });
  return {
    element: labelled(field, id, input),
    answer: () => input.value.trim() || null,
    fault: () => {
      const { badInput, rangeUnderflow, rangeOverflow } = input.validity;
      if (badInput) return words().form.number;
      return rangeUnderflow || rangeOverflow ? words().form.number_between(field.low, field.high) : null;
    },
    focus: () => input.focus(),
  };
}

function askChoice(field: Field, id: string, choices: [string, string][], look = ''): Asked {
  const inputs = choices.map(([value]) => h('input', { type: 'radio', name: id, value }));
  const group = h(
    'fieldset',
    { class: 'asked', role: 'radiogroup', 'aria-required': String(field.required) },
    h('legend', {}, field.label, optional(field)),
    withEnds(
      field,
      h(
        'div',
        { class: `choices ${look}` },
        ...choices.map(([, label], i) => h('label', { class: 'pill' }, inputs[i], h('span', {}, label))),
      ),
    ),
  );
  return {
    element: group,
    answer: () => inputs.find((input) => input.checked)?.value ?? null,
    fault: () => null,
    focus: () => (inputs.find((input) => input.checked) ?? inputs[0])?.focus(),
  };
}

function askList(field: Field, id: string): Asked {
  const nothing = h('option', { value: '' }, words().form.choose);
  const options = field.choices.map((choice) => h('option', { value: choice }, choice));
  const select = h('select', { id, 'aria-required': String(field.required) }, nothing, ...options);
  return {
    element: labelled(field, id, select),
    answer: () => select.value || null,
    fault: () => null,
    focus: () => select.focus(),
  };
}

/** A slider without a position until it is touched, because an initial position would suggest a response. */
function askSlider(field: Field, id: string): Asked {
  const step = scaleStep(field);
  const slider = h('input', {
    id,
    type: 'range',
    class: 'unset',
    min: field.low,
    max: field.high,
    step,
    'aria-required': String(field.required),
    'aria-valuetext': words().form.not_answered,
  });
  const touch = (): void => {
    if (!slider.classList.contains('unset')) return;
    slider.classList.remove('unset');
    slider.removeAttribute('aria-valuetext');
    // A touch at the centre changes no value, but it is a response.
    slider.dispatchEvent(new Event('input', { bubbles: true }));
  };
  slider.addEventListener('input', touch);
  slider.addEventListener('pointerup', touch);
  slider.addEventListener('keydown', (event) => {
    if (event.key === ' ' || event.key === 'Enter') touch();
    if (event.key === ' ') event.preventDefault();
  });
  const marks = Array.from({ length: SCALE_STEPS + 1 }, (_, i) => h('i', { class: i % 10 === 0 ? 'long' : null }));
  return {
    element: h(
      'div',
      { class: 'asked' },
      h('label', { for: id }, field.label, optional(field)),
      withEnds(
        field,
        h('div', { class: 'scale' }, h('div', { class: 'marks', 'aria-hidden': 'true' }, ...marks), slider),
      ),
    ),
    answer: () => (slider.classList.contains('unset') ? null : slider.value),
    fault: () => null,
    focus: () => slider.focus(),
  };
}

/** A scale between the labels of its ends. */
function withEnds({ low_label, high_label }: Field, scale: HTMLElement): HTMLElement {
  if (!low_label && !high_label) return scale;
  const end = (label: string): HTMLElement => h('span', { class: 'end' }, label);
  return h('div', { class: 'with-ends' }, end(low_label), scale, end(high_label));
}
