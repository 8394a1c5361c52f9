// Small dialogs that ask for confirmation.

import { h } from '../panels/html';
import { words } from './words/words';

interface Question {
  title: string;
  text: string;
  stay: string;
  go_on: string;
  /** additional input, above the buttons */
  input?: HTMLInputElement;
  suggestions?: string[];
  /** additional choice, below the suggestions */
  choice?: HTMLElement;
  /** the second button loses nothing */
  harmless?: boolean;
  /** the buttons are swapped, so that a double click on the question before does not answer this one */
  swapped?: boolean;
}

/** Asks for confirmation; `act` needs the second button, and a text if there is an input. */
export function askFirst(question: Question, act: (words: string) => void, otherwise?: () => void): void {
  const { input } = question;
  const go_on = h('button', { type: 'submit', class: question.harmless ? 'primary' : 'danger' }, question.go_on);
  const enable = (): void => {
    go_on.disabled = input !== undefined && input.value.trim() === '';
  };
  const suggestions = (question.suggestions ?? []).map((text) =>
    h(
      'button',
      {
        type: 'button',
        onclick: () => {
          input!.value = text;
          enable();
          input!.focus();
        },
      },
      text,
    ),
  );
  const stay = h('button', { type: 'button', onclick: () => dialog.close() }, question.stay);
  const form = h(
    'form',
    { method: 'dialog' },
    h('h2', { id: 'question-title' }, question.title),
    h('p', {}, question.text),
    input,
    suggestions.length > 0 && h('div', { class: 'suggestions' }, ...suggestions),
    question.choice,
    h('div', { class: 'dialog-buttons' }, ...(question.swapped ? [go_on, stay] : [stay, go_on])),
  );
  const dialog = h('dialog', { class: 'question-dialog', 'aria-labelledby': 'question-title' }, form);
  let sure = false;
  form.addEventListener('submit', () => (sure = true));
  dialog.addEventListener('close', () => {
    dialog.remove();
    if (sure) act(input?.value.trim() ?? '');
    else otherwise?.();
  });
  input?.addEventListener('input', enable);
  enable();
  (document.querySelector('.study') ?? document.body).append(dialog);
  dialog.showModal();
  (input ?? stay).focus();
}

/** Asks a participant twice whether to stop taking part. */
export function askToStop(act: () => void): void {
  const again = (): void => askFirst({ ...words().stop_again, swapped: true }, act);
  askFirst(words().stop_question, again);
}
