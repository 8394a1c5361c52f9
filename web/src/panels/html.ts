// Elements in one expression: h('button', { class: 'quiet', onclick: act }, 'Reset').

type Attributes = Record<string, string | number | boolean | null | undefined | ((event: never) => void)>;
type Child = Node | string | null | undefined | false;

export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === 'function') element.addEventListener(name.replace(/^on/, ''), value as EventListener);
    else element.setAttribute(name, value === true ? '' : String(value));
  }
  element.append(
    ...children.filter((child): child is Node | string => child !== null && child !== undefined && child !== false),
  );
  return element;
}

/** Sets text only when it differs, because every changed text causes a new layout of the page. */
export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

const MINUS = '\u2212';
/** as wide as a digit */
const FIGURE_SPACE = '\u2007';

/** Formats a number with a fixed width: digits are aligned and nothing moves when it changes. */
export function fixed(value: number, digits: number, width: number): string {
  const text = Math.abs(value).toFixed(digits);
  const negative = value < 0 && Number(text) !== 0;
  return ((negative ? MINUS : '') + text).padStart(width, FIGURE_SPACE);
}
