// Settings of this page: from the address first (a snapshot command selects its view that way), else stored from the
// last visit, else the browser's preference.

import { COLOUR_MODES, type ColourMode, type Role, ROLES } from 'haptolith-protocol';
import { languageOf } from './study/words/words';

export const VIEW_NAMES = ['front', 'side', 'top', 'three-quarter'] as const;
export type ViewName = (typeof VIEW_NAMES)[number];
export type Theme = 'dark' | 'light';
/** ways to draw soil: realistic, or as the simulated particles */
export const DRAWINGS = ['grains', 'balls'] as const;
export type Drawing = (typeof DRAWINGS)[number];

export interface Settings {
  view: ViewName;
  colour: ColourMode;
  drawing: Drawing;
  theme: Theme;
  panels: boolean;
  /** the page is drawn for a picture or an animation: always full resolution, without elements that only users need */
  for_pictures: boolean;
  /** role in a study; null: the bed's page */
  study: Role | null;
  /** language of the participant's page: "en", "de" */
  language: string;
}

const THEME_KEY = 'haptolith.theme';
const COLOUR_KEY = 'haptolith.colour';
const DRAWING_KEY = 'haptolith.drawing';

function oneOf<T extends string>(names: readonly T[], value: string | null): T | null {
  return names.find((name) => name === value) ?? null;
}

// Storage can be forbidden (private windows); then nothing is stored.
function recall(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

function remember(key: string, value: string): void {
  try {
    localStorage.setItem(key, value);
  } catch {
    // see recall
  }
}

const THEMES: readonly Theme[] = ['dark', 'light'];

export function readSettings(search: string, prefers_light: boolean): Settings {
  const query = new URLSearchParams(search);
  return {
    view: oneOf(VIEW_NAMES, query.get('view')) ?? 'three-quarter',
    colour: oneOf(COLOUR_MODES, query.get('colour')) ?? oneOf(COLOUR_MODES, recall(COLOUR_KEY)) ?? 'plain',
    drawing: oneOf(DRAWINGS, query.get('drawing')) ?? oneOf(DRAWINGS, recall(DRAWING_KEY)) ?? 'grains',
    theme: oneOf(THEMES, query.get('theme')) ?? oneOf(THEMES, recall(THEME_KEY)) ?? (prefers_light ? 'light' : 'dark'),
    panels: query.get('panels') !== '0',
    for_pictures: query.get('quality') === 'full',
    study: oneOf(ROLES, query.get('study')),
    language: languageOf(query.get('lang')),
  };
}

export const rememberTheme = (theme: Theme): void => remember(THEME_KEY, theme);
export const rememberDrawing = (drawing: Drawing): void => remember(DRAWING_KEY, drawing);
export const rememberColour = (colour: ColourMode): void => remember(COLOUR_KEY, colour);
