// Fixed words of the participant's page, one file per language. The protocol's key `language` selects it: the program
// prints the page's address with `&lang=de`. A new language is a new file and an entry in LANGUAGES.

import type { Phase } from 'haptolith-protocol';
import { DE } from './de';
import { EN } from './en';

interface Dialog {
  title: string;
  text: string;
  stay: string;
  go_on: string;
}

export interface Words {
  titles: Partial<Record<Phase, string>>;
  texts: Partial<Record<Phase, string>>;
  feedback: { right: string; wrong: string; none: string };
  continue: string;
  touch_first: string;
  part(block: number, blocks: number): string;
  trial(trial: number, trials: number): string;
  page_title: string;
  connection_lost: string;
  too_long: string;
  stop: string;
  stop_failed: string;
  stop_question: Dialog;
  stop_again: Dialog;
  form: {
    required: string;
    optional: string;
    yes: string;
    no: string;
    number: string;
    number_between(low: number, high: number): string;
    choose: string;
    not_answered: string;
  };
  /** Translates the fixed words that the program sends; returns other text, such as the protocol's, unchanged. */
  fromProgram(text: string): string;
}

const LANGUAGES: Record<string, Words> = { en: EN, de: DE };

/** Language of a BCP 47 tag that has words ("de" of "de-CH"); "en" otherwise. */
export function languageOf(tag: string | null): string {
  const language = (tag ?? '').toLowerCase().split('-')[0]!;
  return Object.hasOwn(LANGUAGES, language) ? language : 'en';
}

let chosen = EN;

export function chooseLanguage(tag: string): void {
  chosen = LANGUAGES[languageOf(tag)]!;
}

/** Words of the chosen language. */
export function words(): Words {
  return chosen;
}
