// Words of the participant's page in German.

import type { Words } from './words';

/** Words that the program sends in English. */
const FROM_PROGRAM: Record<string, string> = {
  Continue: 'Weiter',
  'I agree and take part': 'Ich stimme zu und nehme teil',
  'I am done': 'Fertig',
  'I am done: answer': 'Fertig: zur Antwort',
  First: 'Erster Reiz',
  Second: 'Zweiter Reiz',
  'About you': 'Angaben zu Ihrer Person',
  'About the whole study': 'Zur gesamten Studie',
  'About the trials that you have just completed.': 'Zu den Durchgängen, die Sie gerade abgeschlossen haben.',
  'Welcome back': 'Willkommen zurück',
  'You continue where you were.': 'Sie machen dort weiter, wo Sie aufgehört haben.',
  'Task completed': 'Aufgabe erledigt',
  'Time is over': 'Die Zeit ist abgelaufen',
};

export const DE: Words = {
  titles: {
    waiting: 'Bitte warten',
    consent: 'Teilnahme',
    form: 'Einige Fragen',
    instructions: 'Anleitung',
    preparing: 'Einen Moment',
    break: 'Zeit für eine Pause',
    paused: 'Kurze Unterbrechung',
    finished: 'Vielen Dank',
    withdrawn: 'Vielen Dank',
    stopped: 'Vielen Dank, das ist für heute alles',
  },
  texts: {
    waiting: 'Die Studie beginnt gleich.',
    preparing: 'Der nächste Durchgang wird vorbereitet.',
    paused: 'Die Studie geht gleich weiter. Bitte bleiben Sie an Ihrem Platz.',
    finished: 'Sie haben die Studie abgeschlossen.',
    withdrawn: 'Sie haben die Teilnahme beendet. Sie müssen nichts weiter tun.',
  },
  feedback: { right: 'Richtig', wrong: 'Nicht richtig', none: 'Vielen Dank' },
  continue: 'Weiter',
  touch_first: 'Berühren Sie zuerst den Boden mit dem Werkzeug.',
  part: (block, blocks) => `Teil ${block} von ${blocks}`,
  trial: (trial, trials) => `${trial} von ${trials}`,
  page_title: 'Studie, haptolith',
  connection_lost: 'Verbindung unterbrochen',
  too_long: 'Ihre Antwort ist zu lang. Bitte kürzen Sie sie.',
  stop: 'Teilnahme beenden',
  stop_failed: 'Bitte sagen Sie der Versuchsleitung Bescheid.',
  stop_question: {
    title: 'Möchten Sie die Teilnahme beenden?',
    text: 'Sie können jederzeit aufhören, ohne Gründe zu nennen.',
    stay: 'Nein, weiter',
    go_on: 'Beenden',
  },
  stop_again: {
    title: 'Sind Sie sicher?',
    text: 'Die Studie endet dann für Sie.',
    stay: 'Nein, weiter',
    go_on: 'Ja, beenden',
  },
  form: {
    required: 'Bitte beantworten Sie diese Frage.',
    optional: ' (freiwillig)',
    yes: 'Ja',
    no: 'Nein',
    number: 'Bitte geben Sie eine Zahl ein.',
    number_between: (low, high) => `Bitte geben Sie eine Zahl von ${low} bis ${high} ein.`,
    choose: 'Bitte wählen',
    not_answered: 'noch nicht beantwortet',
  },
  fromProgram: (text) =>
    FROM_PROGRAM[text] ?? text.replace(/^Preparing soil (\d+) of (\d+)\.$/, 'Boden $1 von $2 wird vorbereitet.'),
};
