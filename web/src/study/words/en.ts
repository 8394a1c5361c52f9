// Words of the participant's page in English.

import type { Words } from './words';

export const EN: Words = {
  titles: {
    waiting: 'Please wait',
    consent: 'Taking part',
    form: 'A few questions',
    instructions: 'Instructions',
    preparing: 'One moment',
    break: 'Time for a break',
    paused: 'A short pause',
    finished: 'Thank you',
    withdrawn: 'Thank you',
    stopped: 'Thank you, that is all for today',
  },
  texts: {
    waiting: 'The study starts soon.',
    preparing: 'The next trial is being prepared.',
    paused: 'The study continues in a moment. Please stay where you are.',
    finished: 'You have completed the study.',
    withdrawn: 'You have stopped taking part. There is nothing more to do.',
  },
  feedback: { right: 'Correct', wrong: 'Not correct', none: 'Thank you' },
  continue: 'Continue',
  touch_first: 'Touch the soil with the tool first.',
  part: (block, blocks) => `Part ${block} of ${blocks}`,
  trial: (trial, trials) => `${trial} of ${trials}`,
  page_title: 'Study, haptolith',
  connection_lost: 'Connection lost',
  too_long: 'Your answer is too long. Please shorten it.',
  stop: 'Stop taking part',
  stop_failed: 'Please tell the experimenter.',
  stop_question: {
    title: 'Do you want to stop taking part?',
    text: 'You can stop at any time, without giving a reason.',
    stay: 'No, continue',
    go_on: 'Stop',
  },
  stop_again: {
    title: 'Are you sure?',
    text: 'The study then ends for you.',
    stay: 'No, continue',
    go_on: 'Yes, stop',
  },
  form: {
    required: 'Please answer this question.',
    optional: ' (optional)',
    yes: 'Yes',
    no: 'No',
    number: 'Please enter a number.',
    number_between: (low, high) => `Please enter a number from ${low} to ${high}.`,
    choose: 'Please choose',
    not_answered: 'not answered yet',
  },
  fromProgram: (text) => text,
};
