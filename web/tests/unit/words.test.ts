import { describe, expect, it } from 'vitest';
import { readSettings } from '../../src/settings';
import { DE } from '../../src/study/words/de';
import { EN } from '../../src/study/words/en';
import { chooseLanguage, languageOf, words } from '../../src/study/words/words';

/** Paths of all words: "titles.waiting", ... */
function paths(value: object, above = ''): string[] {
  return Object.entries(value).flatMap(([key, entry]) =>
    typeof entry === 'object' ? paths(entry as object, `${above}${key}.`) : [`${above}${key}`],
  );
}

describe("the words of the participant's page", () => {
  it('are complete in every language', () => {
    expect(paths(DE)).toEqual(paths(EN));
  });

  it('are those of the language in the address, English by default', () => {
    expect(readSettings('?study=participant&lang=de', false).language).toBe('de');
    expect(languageOf('de-CH')).toBe('de');
    for (const unknown of [null, '', 'tlh', 'toString']) expect(languageOf(unknown)).toBe('en');
    expect(words()).toBe(EN);
    chooseLanguage('de');
    expect(words()).toBe(DE);
    chooseLanguage('en');
  });

  it('include those that the program sends, and leave the texts of the protocol unchanged', () => {
    expect(DE.fromProgram('Continue')).toBe('Weiter');
    expect(DE.fromProgram('Preparing soil 2 of 6.')).toBe('Boden 2 von 6 wird vorbereitet.');
    expect(DE.fromProgram('Which was heavier?')).toBe('Which was heavier?');
    expect(EN.fromProgram('Continue')).toBe('Continue');
  });
});
