// The experimenter's page: the scene, the progress of the study, the stimuli, the responses, and the controls.

import type { ExperimenterMessage, Frame, Phase, Scene, Status, StudyCommand, StudyMessage } from 'haptolith-protocol';
import { publish } from '../automation';
import { Connection, type Program } from '../connection';
import { Hand } from '../hand/hand';
import { PointerHand } from '../hand/pointer_hand';
import { fixed, h, setText } from '../panels/html';
import { Notices } from '../panels/notices';
import { Plots, steppedRange, type PlotSpec } from '../panels/plots';
import { rememberTheme, type Settings, type Theme } from '../settings';
import { isTyping } from '../shortcuts';
import { Stage } from '../view/stage';
import { AnswersTable } from './answers_table';
import { askFirst } from './dialogs';
import { NotesPanel } from './notes_panel';
import { ResultsPanel } from './results_panel';
import { shareDone } from './shown';
import { trialCard } from './trial_card';

const JOIN_AGAIN_MS = 2000;

const PHASE_WORDS: Record<Phase, string> = {
  waiting: 'waiting for the participant',
  consent: 'reading the consent page',
  form: 'filling in a form',
  instructions: 'reading the instructions',
  preparing: 'the bed is being prepared',
  interval: 'exploring the soil',
  question: 'answering',
  feedback: 'seeing the feedback',
  break: 'taking a break',
  paused: 'paused',
  finished: 'finished',
  withdrawn: 'withdrew',
  stopped: 'stopped for today',
};

const FORCE: PlotSpec = {
  title: 'Force',
  unit: 'N',
  lines: [{ name: 'size', colour: '--accent', width: 1.5 }],
  sample: (frame) => [Math.hypot(...frame.force_n)],
  range: steppedRange(0.5),
};

const BLINDED = 'Hidden to keep you blind to the condition.';
const REASONS = ['distracted', 'pressed the wrong key', 'did not touch the soil', 'problem with the device'];

export function openExperimenterPage(settings: Settings, program: Program): void {
  const now = {
    hello: null as { client: number } | null,
    scene: null as Scene | null,
    status: null as Status | null,
    frame: null as Frame | null,
    study: null as ExperimenterMessage | null,
    theme: settings.theme,
    blinded: true,
  };

  const notices = new Notices(() => connection.retryNow());
  const connection = new Connection(program, {
    hello: (hello) => {
      now.hello = hello;
      force_plot.clear();
      join();
    },
    scene: (scene) => {
      now.scene = scene;
      stage.setScene(scene);
    },
    status: (status) => {
      now.status = status;
      stage.watchLoop(status);
    },
    frame: (frame) => {
      now.frame = frame;
      stage.setFrame(frame, frame.held);
      force_plot.setFrame(frame);
    },
    study: onStudy,
    link: (connected, why) => {
      notices.setLink(connected, why);
      page.classList.toggle('offline', !connected);
    },
    damaged: (error) => notices.toast(error instanceof Error ? error.message : String(error)),
  });

  const ask = (command: StudyCommand): Promise<void> =>
    connection.request(command).catch((error: Error) => {
      notices.toast(error.message);
      throw error;
    });
  const tell = (command: StudyCommand): void => void ask(command).catch(() => {});

  const title = h('strong', { class: 'study-title' }, 'Study');
  const file = h('span', { class: 'title' });
  const participant = h('strong', { class: 'participant-code' }, '–');
  const group = h('span', { class: 'participant-group', hidden: true });
  const phase = h('span', { class: 'phase' }, 'not connected to a study');
  const progress_text = h('span', { class: 'numbers progress-text' });
  const progress_bar = h('div', { class: 'progress-bar', 'aria-hidden': 'true' });
  const problem = h('div', { class: 'problem', role: 'alert', hidden: true });
  const ended = h('div', { class: 'ended', role: 'status', hidden: true });
  const theme_button = h(
    'button',
    {
      type: 'button',
      class: 'icon-button',
      'aria-label': 'Dark or light',
      title: 'Dark or light (T)',
      onclick: () => setTheme(now.theme === 'dark' ? 'light' : 'dark'),
    },
    '◐',
  );

  const pause_button = h('button', { type: 'button', class: 'main', title: 'Pause or resume (P)', onclick: pause });
  const repeat_button = h(
    'button',
    { type: 'button', title: 'Repeat a trial (R)', onclick: repeat },
    'Repeat a trial…',
  );
  const note_button = h('button', { type: 'button', title: 'Write a note (N)', onclick: () => notes.focus() }, 'Note');
  const end_button = h('button', { type: 'button', class: 'end', onclick: askToEnd }, 'End for today…');
  const now_body = h('div', { class: 'trial', 'aria-live': 'polite' });
  const next_body = h('div', { class: 'trial' });
  const unblind_button = h('button', { type: 'button', class: 'unblind', 'aria-pressed': 'false', onclick: unblind });
  const buttons = [pause_button, repeat_button, note_button, end_button, unblind_button];

  const force_plot = new Plots([FORCE]);
  const force = h('span', { class: 'force-number numbers', 'data-test': 'force' }, '–');
  const peak = h('span', { class: 'unit numbers' });
  const results = new ResultsPanel();
  const no_results = h(
    'section',
    { class: 'card no-results', 'aria-label': 'Psychometric functions' },
    h('h2', {}, 'Psychometric functions'),
    h('p', { class: 'nothing' }, BLINDED),
  );
  const answers = new AnswersTable();
  const notes = new NotesPanel((text) => ask({ do: 'study', act: 'note', text }));

  const view = h('main', { class: 'view', 'aria-label': 'The bed' }, notices.banner, notices.toasts);
  const page = h(
    'div',
    { class: 'study experimenter' },
    h(
      'header',
      { class: 'strip' },
      h('div', { class: 'brand' }, title, file),
      h('div', { class: 'who' }, participant, group, phase),
      h('div', { class: 'progress' }, progress_text, progress_bar),
      h(
        'div',
        { class: 'strip-buttons' },
        pause_button,
        repeat_button,
        note_button,
        end_button,
        unblind_button,
        theme_button,
      ),
    ),
    problem,
    ended,
    h(
      'div',
      { class: 'left' },
      view,
      h(
        'section',
        { class: 'force-card', 'aria-label': 'Force on the hand' },
        h('div', { class: 'force-now' }, h('span', { class: 'unit' }, 'force'), force, peak),
        force_plot.element,
      ),
    ),
    h(
      'div',
      { class: 'right' },
      h('section', { class: 'card', 'aria-label': 'Shown now' }, h('h2', {}, 'Now'), now_body),
      h('section', { class: 'card', 'aria-label': 'Shown next' }, h('h2', {}, 'Next'), next_body),
      results.element,
      no_results,
      answers.element,
      notes.element,
    ),
  );
  document.querySelector('#app')!.append(page);

  const stage = new Stage(view, {
    reduced_motion: matchMedia('(prefers-reduced-motion: reduce)').matches,
    full_quality: settings.for_pictures,
  });
  const hand = new Hand(
    connection,
    () => {},
    () => {},
  );
  const pointer = new PointerHand(stage, hand, stage.renderer.domElement);
  pointer.may_dig = false;

  stage.onTick = (now_ms) => force_plot.tick(now_ms);
  stage.setView(settings.view, false);
  setTheme(now.theme, false);
  addEventListener('keydown', onKeyDown);
  document.addEventListener('visibilitychange', () => {
    if (!document.hidden) connection.retryNow();
  });
  show(null);
  stage.start();
  connection.open();
  publish({
    stage,
    connection,
    now,
    setColour: (mode) => stage.setColour(mode),
    setDrawing: (drawing) => stage.setDrawing(drawing),
    setTheme,
  });

  function join(): void {
    connection.request({ do: 'study', act: 'join', as: 'experimenter' }).catch((error: Error) => {
      if (!connection.connected) return;
      show(null);
      setText(phase, error.message);
      delete phase.dataset.phase;
      setTimeout(() => connection.connected && join(), JOIN_AGAIN_MS);
    });
  }

  function onStudy(message: StudyMessage): void {
    if (message.as === 'experimenter') show(message);
  }

  function show(message: ExperimenterMessage | null): void {
    now.study = message;
    for (const button of buttons) button.disabled = message === null;
    setText(pause_button, message?.paused ? 'Resume' : 'Pause');
    showBlinded();
    if (!message) return;
    const over = ['finished', 'withdrawn', 'stopped'].includes(message.phase);
    repeat_button.disabled = over || message.progress === null;
    pause_button.disabled = over;
    setText(title, message.study);
    setText(file, message.file);
    setText(participant, message.participant || '–');
    setText(phase, phaseWords(message));
    phase.dataset.phase = message.paused ? 'paused' : message.phase;
    document.title = `${message.participant} · ${message.study}, haptolith`;
    const { progress } = message;
    setText(progress_text, progressText(progress));
    progress_bar.style.setProperty('--share', String(over ? 1 : shareDone(progress)));
    problem.hidden = message.problem === null;
    setText(problem, message.problem ?? '');
    setText(force, `${fixed(message.force_n, 2, 5)} N`);
    setText(peak, `peak ${fixed(message.peak_force_n, 1, 4)} N`);
    answers.set(message.answers, now.blinded);
    notes.set(message.notes);
    if (message.ended !== null) end(message.ended);
  }

  /** Ends the page with the program: the last state is kept, and all controls are disabled. */
  function end(how: string): void {
    for (const button of buttons) button.disabled = true;
    notes.element.inert = true;
    problem.hidden = true;
    ended.hidden = false;
    setText(ended, how);
    connection.close();
  }

  function showTrial(host: HTMLElement, trial: ExperimenterMessage['now'], nothing: string): void {
    const shown = JSON.stringify([trial, nothing]);
    if (host.dataset.shown === shown) return;
    host.dataset.shown = shown;
    host.replaceChildren(...trialCard(trial, nothing));
  }

  /** Shows stimuli, correct responses and curves only after unblinding. */
  function showBlinded(): void {
    const { blinded, study } = now;
    setText(unblind_button, blinded ? 'Unblind…' : 'Blind again');
    unblind_button.setAttribute('aria-pressed', String(!blinded));
    showTrial(now_body, blinded ? null : (study?.now ?? null), blinded ? BLINDED : 'No stimulus now.');
    showTrial(next_body, blinded ? null : (study?.next ?? null), blinded ? BLINDED : 'Not known yet.');
    group.hidden = blinded || !study?.group;
    setText(group, blinded || !study?.group ? '' : `group ${study.group}`);
    results.set(study?.blocks ?? [], blinded);
    no_results.hidden = !blinded;
    answers.set(study?.answers ?? [], blinded);
    stage.setNeutral(blinded);
  }

  function unblind(): void {
    if (!now.blinded) return setBlinded(true);
    askFirst(
      {
        title: 'Show the stimuli?',
        text: 'This page then shows the stimuli, the correct responses and the group of the participant. You could disclose them without noticing. The study stores a note that you unblinded the page.',
        stay: 'Stay blinded',
        go_on: 'Unblind',
      },
      () => setBlinded(false),
    );
  }

  /** Changes the blinding only after it has been recorded in the study. */
  function setBlinded(blinded: boolean): void {
    const text = blinded ? 'blinded again' : 'unblinded: the experimenter sees stimuli, correct responses and curves';
    ask({ do: 'study', act: 'note', text }).then(
      () => {
        now.blinded = blinded;
        showBlinded();
      },
      () => {},
    );
  }

  function pause(): void {
    tell({ do: 'study', act: now.study?.paused ? 'resume' : 'pause' });
  }

  function repeat(): void {
    const input = h('input', { type: 'text', 'aria-label': 'Reason', placeholder: 'Why?', maxlength: 500 });
    const last = h('input', { type: 'checkbox' });
    askFirst(
      {
        title: 'Repeat a trial',
        text: 'The running trial is repeated; between trials, the last answered one. Its response is kept and marked as repeated, with your reason.',
        input,
        suggestions: REASONS,
        choice: h('label', { class: 'check' }, last, ' Repeat the last answered trial instead of the running one'),
        stay: 'Cancel',
        go_on: 'Repeat trial',
      },
      (reason) => tell({ do: 'study', act: 'repeat', which: last.checked ? 'last' : 'now', reason }),
    );
  }

  function askToEnd(): void {
    askFirst(
      {
        title: `End for today?`,
        text: 'This ends the session for today. All responses are kept, and the study can be resumed later.',
        stay: 'Cancel',
        go_on: 'End for today',
      },
      () => tell({ do: 'study', act: 'end' }),
    );
  }

  function setTheme(theme: Theme, remember = true): void {
    now.theme = theme;
    document.documentElement.dataset.theme = theme;
    if (remember) rememberTheme(theme);
    force_plot.restyle();
  }

  function onKeyDown(event: KeyboardEvent): void {
    if (document.querySelector('dialog[open]') || isTyping(event) || event.repeat) return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const press: Record<string, HTMLButtonElement> = {
      p: pause_button,
      r: repeat_button,
      n: note_button,
      t: theme_button,
    };
    const button = press[event.key.toLowerCase()];
    if (!button) return;
    event.preventDefault();
    button.click();
  }
}

function phaseWords({ paused, phase, now }: ExperimenterMessage): string {
  if (paused) return PHASE_WORDS.paused;
  if (phase === 'interval' && now) return now.interval === 2 ? 'exploring the second' : 'exploring the first';
  return PHASE_WORDS[phase];
}

function progressText(progress: ExperimenterMessage['progress']): string {
  if (!progress) return '';
  const trial = progress.trial > 0 ? ` · trial ${progress.trial}` : '';
  const of = progress.trials === null || progress.trial === 0 ? '' : ` of ${progress.trials}`;
  return `part ${progress.block} of ${progress.blocks}${trial}${of}`;
}
