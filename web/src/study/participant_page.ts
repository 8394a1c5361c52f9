// The participant's page: one thing at a time, without any hint at the stimulus (blinding).

import type { Frame, ParticipantMessage, Phase, Scene, Status, StudyCommand, StudyMessage } from 'haptolith-protocol';
import { publish } from '../automation';
import { Connection, NO_TOKEN, type Program } from '../connection';
import { Hand } from '../hand/hand';
import { KeyHand } from '../hand/key_hand';
import { PointerHand } from '../hand/pointer_hand';
import { ToolTilt } from '../hand/tilt';
import { h, setText } from '../panels/html';
import { Notices } from '../panels/notices';
import { SiteCard } from '../panels/site_card';
import type { Settings } from '../settings';
import { isTyping } from '../shortcuts';
import { Stage } from '../view/stage';
import { Countdown } from './countdown';
import { askToStop } from './dialogs';
import { isTooLong } from './form';
import { LateFrames } from './late_frames';
import { OneAct } from './one_act';
import { Prompts } from './prompts';
import { asSentence, shareDone, waiting, whatIsShown } from './shown';
import { mustTouch, Touch } from './touch';
import { chooseLanguage, words } from './words/words';

const JOIN_AGAIN_MS = 2000;
const CLOCK_INTERVAL_MS = 100;
const OVER: Phase[] = ['finished', 'withdrawn', 'stopped'];
const BESIDE_BLOCKS: Phase[] = ['waiting', 'consent', ...OVER];

export function openParticipantPage(settings: Settings, program: Program): void {
  chooseLanguage(settings.language);
  document.documentElement.lang = settings.language;
  const now = {
    hello: null as { client: number } | null,
    scene: null as Scene | null,
    status: null as Status | null,
    frame: null as Frame | null,
    study: null as ParticipantMessage | null,
    shown: '',
  };
  const act = new OneAct();
  const countdown = new Countdown();
  const touch = new Touch();

  const notices = new Notices(() => connection.retryNow());
  const connection = new Connection(program, {
    hello: (hello) => {
      now.hello = hello;
      join();
    },
    scene: (scene) => {
      now.scene = scene;
      late.clear();
      stage.setScene(scene);
      hand.setScene(scene);
    },
    status: (status) => {
      now.status = status;
      stage.setRobot(status.robot ?? null);
      stage.watchLoop(status);
      site_card.setRobot(status.robot ?? null);
      if (status.paused || (status.held_by !== null && status.held_by !== now.hello?.client)) hand.giveUp();
    },
    frame: (frame) => {
      now.frame = frame;
      hand.setFrame(frame);
      if (touch.felt(frame.force_n)) prompts.hold(null);
      late.add(frame, performance.now());
    },
    study: onStudy,
    link: onLink,
    damaged: (error) => notices.toast(error instanceof Error ? error.message : String(error)),
  });

  const prompts = new Prompts(
    {
      go: () => send({ do: 'study', act: 'go' }),
      fill: (values) => {
        if (isTooLong(values)) notices.toast(words().too_long);
        else send({ do: 'study', act: 'fill', values });
      },
      answer: (choice) => send({ do: 'study', act: 'answer', choice }, choice),
    },
    countdown,
  );
  const progress_text = h('span', { class: 'numbers' });
  const progress_bar = h('div', { class: 'progress-bar', 'aria-hidden': 'true' });
  const problem = h('div', { class: 'problem', role: 'alert', hidden: true });
  const stop_button = h('button', { type: 'button', class: 'stop', onclick: stop }, words().stop);
  const view = h('div', { class: 'view', 'aria-hidden': 'true' });
  const site_card = new SiteCard();
  const page = h(
    'div',
    { class: 'study participant' },
    view,
    site_card.element,
    h('header', { class: 'participant-head' }, progress_bar, progress_text, stop_button),
    prompts.element,
    prompts.announcer,
    problem,
    notices.banner,
    notices.toasts,
  );
  document.querySelector('#app')!.append(page);
  document.documentElement.dataset.theme = settings.theme;
  document.title = words().page_title;

  const stage = new Stage(view, {
    reduced_motion: matchMedia('(prefers-reduced-motion: reduce)').matches,
    full_quality: settings.for_pictures,
    neutral: true,
  });
  stage.site_window = site_card.window;
  const late = new LateFrames((frame) => stage.setFrame(frame, frame.held));
  const hand = new Hand(
    connection,
    // Taking the tool as the interval ends is too late; this error is not shown.
    (error) => now.study?.phase === 'interval' && notices.toast(asSentence(error.message)),
    () => stage.invalidate(),
  );
  const tilt = new ToolTilt(
    hand,
    () => now.scene,
    () => now.frame,
    () => stage.orbit.right().toArray(),
  );
  const pointer = new PointerHand(stage, hand, stage.renderer.domElement, () => tilt.taken());
  const keys = new KeyHand(hand, stage.orbit, () => (now.scene?.box.width_m ?? 0.126) / 0.126);

  stage.onTick = (now_ms) => {
    keys.tick(now_ms);
    tilt.tick(now_ms);
    hand.tick(now_ms);
    late.tick(performance.now());
  };
  stage.setView(settings.view, false);
  addEventListener('keydown', onKeyDown, { capture: true });
  page.addEventListener('click', (event) => {
    if (event.target instanceof Element && event.target.closest('dialog')) act.settle();
  });
  addEventListener('keyup', (event) => keys.up(event));
  document.addEventListener('visibilitychange', () => {
    if (!document.hidden) connection.retryNow();
  });
  setInterval(() => prompts.tick(), CLOCK_INTERVAL_MS);
  onStudy(waiting(''));
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

  function setTheme(theme: Settings['theme']): void {
    document.documentElement.dataset.theme = theme;
  }

  function join(): void {
    connection.request({ do: 'study', act: 'join', as: 'participant' }).catch((error: Error) => {
      if (!connection.connected) return;
      onStudy(waiting(asSentence(error.message)));
      setTimeout(() => connection.connected && join(), JOIN_AGAIN_MS);
    });
  }

  function onStudy(message: StudyMessage): void {
    if (message.as !== 'participant') return;
    now.study = message;
    const shown = whatIsShown(message);
    if (shown !== now.shown) {
      now.shown = shown;
      act.renew();
      countdown.begin(message.remaining_s);
      prompts.show(message);
      touch.begin();
      if (mustTouch(message)) prompts.hold(words().touch_first);
      showScene(message);
      showProgress(message);
      page.dataset.phase = message.phase;
      stop_button.hidden = OVER.includes(message.phase) || message.study === '';
    }
    countdown.set(message.remaining_s);
    prompts.setWork(message.work);
    problem.hidden = message.problem === null;
    setText(problem, message.problem ?? '');
    if (message.ended) connection.close();
  }

  function showScene(message: ParticipantMessage): void {
    const feels = message.phase === 'interval';
    const can_dig = feels && message.can_dig;
    const visible = feels && message.visual;
    page.classList.toggle('scene-shown', visible);
    page.classList.toggle('can-dig', can_dig);
    if (!can_dig) hand.giveUp();
    pointer.may_dig = can_dig;
    // An invisible tool cannot be aimed at.
    pointer.dig_anywhere = can_dig && !visible;
    stage.shown = visible;
    late.setDelay(visible ? message.visual_delay_s : 0, performance.now());
    stage.over = page.querySelector<HTMLElement>('.interval-label');
    stage.refit();
  }

  function showProgress({ progress, phase }: ParticipantMessage): void {
    const in_block = progress !== null && !BESIDE_BLOCKS.includes(phase);
    const trial = progress && progress.trial > 0 && progress.trials !== null ? progress : null;
    setText(
      progress_text,
      !in_block
        ? ''
        : words().part(progress.block, progress.blocks) +
            (trial ? ` · ${words().trial(trial.trial, trial.trials!)}` : ''),
    );
    progress_bar.hidden = !in_block;
    progress_bar.style.setProperty('--share', String(shareDone(progress)));
  }

  function onLink(connected: boolean, why: string | null): void {
    notices.setLink(connected, why === null || why === NO_TOKEN ? why : words().connection_lost);
    page.classList.toggle('offline', !connected);
    if (connected) return;
    hand.drop();
    act.giveBack();
    prompts.lock(false);
  }

  function send(command: StudyCommand, choice: 0 | 1 | null = null): void {
    if (!act.take()) return;
    prompts.lock(true, choice);
    const shown = now.shown;
    connection.request(command).catch((error: Error) => {
      if (shown !== now.shown) return;
      act.giveBack();
      prompts.lock(false);
      notices.toast(asSentence(error.message));
    });
  }

  function stop(): void {
    askToStop(() =>
      connection
        .request({ do: 'study', act: 'quit' })
        .catch((error: Error) => notices.toast(`${asSentence(error.message)} ${words().stop_failed}`)),
    );
  }

  function onKeyDown(event: KeyboardEvent): void {
    if (document.querySelector('dialog[open]') || event.ctrlKey || event.metaKey || event.altKey) return;
    const study = now.study!;
    if (study.phase === 'interval' && study.can_dig && keys.down(event)) return event.preventDefault();
    const press = pressOf(event, study);
    if (!press) return;
    event.preventDefault();
    // Repeats of a pressed key are ignored.
    if (!event.repeat) press();
  }

  /** Returns the action of a key in this phase, independent of the focus; null: the default action. */
  function pressOf(event: KeyboardEvent, study: ParticipantMessage): (() => void) | null {
    if (study.phase === 'question') {
      if (event.key === '1' || event.key === 'ArrowLeft') return () => prompts.choose(0);
      if (event.key === '2' || event.key === 'ArrowRight') return () => prompts.choose(1);
    }
    if (event.key !== 'Enter' && event.key !== ' ') return null;
    const on_button = event.target instanceof HTMLButtonElement;
    if (event.repeat && on_button) return () => {};
    if (on_button || isTyping(event) || study.phase === 'form' || study.button === null) return null;
    if (mustTouch(study) && !touch.was_felt) return () => {};
    return () => send({ do: 'study', act: 'go' });
  }
}
