// A mock of a study: two blocks of comparisons, run as in the program, with times short enough for tests.

import type {
  Answer,
  BlockResult,
  Command,
  ExperimenterMessage,
  Field,
  Note,
  ParticipantMessage,
  Phase,
  Role,
  StudyCommand,
  StudyMessage,
  TrialKind,
  TrialShown,
} from 'haptolith-protocol';
import { waiting } from '../src/study/shown';

export interface MockStudyOptions {
  interval_s?: number;
  preparing_s?: number;
  feedback_s?: number;
  break_s?: number;
  visual?: boolean;
  visual_delay_s?: number;
}

interface Block {
  name: string;
  axis_label: string;
  question: string;
  choices: [string, string];
  instructions: string;
  reference: [string, number];
  levels: [string, number][];
  /** slope of the psychometric curve of the simulated participant, in powers of ten */
  slope: number;
}

const BLOCKS: Block[] = [
  {
    name: 'friction',
    axis_label: 'friction coefficient',
    question: 'Was the second harder to dig in than the first?',
    choices: ['Easier', 'Harder'],
    instructions:
      'You will dig in two soils, one after the other.\n\nThen say whether the second was easier or harder to dig in than the first. ' +
      'There is no right way to dig: stir, press and scoop as you like.',
    reference: ['P3', 0.835],
    levels: [
      ['P6', 0.6],
      ['P5', 0.648],
      ['P4', 0.735],
      ['P2', 1],
      ['P1', 1.21],
    ],
    slope: 22,
  },
  {
    name: 'gravity',
    axis_label: 'gravity, m/s²',
    question: 'Was the second heavier than the first?',
    choices: ['Lighter', 'Heavier'],
    instructions:
      'Now two worlds, one after the other.\n\nSay whether soil weighed less or more on the second than on the first.',
    reference: ['Moon', 1.625],
    levels: [
      ['Ceres', 0.27],
      ['Pluto', 0.62],
      ['Europa', 1.315],
      ['Mars', 3.72],
      ['Earth', 9.81],
    ],
    slope: 4,
  },
];
const REPEATS = 3;
const ENOUGH_FOR_A_CURVE = 6;

const scale = (key: string, label: string, low_label = 'very low', high_label = 'very high'): Field => ({
  ...field(key, label, 'scale'),
  high: 100,
  low_label,
  high_label,
  required: true,
});

function field(key: string, label: string, kind: Field['kind'], more: Partial<Field> = {}): Field {
  return { key, label, kind, choices: [], low: 0, high: 0, low_label: '', high_label: '', required: false, ...more };
}

const DEMOGRAPHICS: Field[] = [
  field('age', 'Age', 'number', { low: 18, high: 99, required: true }),
  field('hand', 'Hand you write with', 'choice', { choices: ['left', 'right', 'both'], required: true }),
  field('device', 'Have you used a haptic device before?', 'yes-no', { required: true }),
  field('games', 'How often do you play video games?', 'scale', {
    low: 1,
    high: 7,
    low_label: 'never',
    high_label: 'every day',
  }),
  field('job', 'Field of work or study', 'text'),
];

const NASA_TLX: Field[] = [
  scale('mental', 'How mentally demanding was the task?'),
  scale('physical', 'How physically demanding was the task?'),
  scale('temporal', 'How hurried or rushed was the pace?'),
  scale('performance', 'How successful were you in doing it?', 'perfect', 'failure'),
  scale('effort', 'How hard did you have to work for that?'),
  scale('frustration', 'How insecure, irritated or annoyed were you?'),
];

interface Trial {
  block: number;
  kind: TrialKind;
  test: [string, number];
  number: number;
}

/** One screen of the participant's page. */
interface Screen {
  message: Partial<ParticipantMessage> & { phase: Phase };
  block: number;
  trial?: Trial;
  /** time after which it continues automatically */
  auto_s?: number;
  /** time after which the button appears */
  button_after_s?: number;
}

export const ENDED = 'S01 stopped after 6 of 15 trials; resume with: haptolith study resume friction.study';

export class MockStudy {
  private readonly options: Required<MockStudyOptions>;
  private readonly roles = new Map<number, Role>();
  private readonly answers: Answer[] = [];
  private readonly notes: Note[] = [];
  /** completed forms */
  readonly filled: Record<string, string>[] = [];
  private screens: Screen[];
  private at = 0;
  private begun_ms = Date.now();
  private paused = false;
  private ended = false;
  private withdrawn = false;
  private peak_n = 0;
  problem: string | null = null;

  constructor(options: MockStudyOptions = {}) {
    this.options = {
      interval_s: 20,
      preparing_s: 1,
      feedback_s: 1.5,
      break_s: 10,
      visual: true,
      visual_delay_s: 0,
      ...options,
    };
    this.screens = this.allScreens();
  }

  // ---- requests of the server

  obey(client: number, command: StudyCommand): string | null {
    if (command.act === 'join') {
      // The program identifies it by the address; here a client chooses its role on joining, once.
      const role = this.roles.get(client) ?? command.as;
      if (role !== command.as) return `as = ${command.as} is not valid: must be ${role}: the address is the ${role}'s`;
      this.roles.set(client, role);
      return null;
    }
    const role = this.roles.get(client);
    if (!role) return 'join the study first';
    return role === 'participant' ? this.obeyParticipant(command) : this.obeyExperimenter(command);
  }

  left(client: number): void {
    this.roles.delete(client);
  }

  refuse(client: number, command: Command): string | null {
    const role = this.roles.get(client);
    if (!role || command.do === 'colour' || command.do === 'release') return null;
    if (command.do === 'hold' && role === 'participant' && this.screen.message.phase === 'interval') return null;
    return 'a study is running';
  }

  /** Returns the current messages for each client. */
  messages(force_n: number): [number, StudyMessage][] {
    this.peak_n = Math.max(this.peak_n, force_n);
    const { auto_s } = this.screen;
    if (auto_s !== undefined && !this.paused && this.elapsed_s >= auto_s) this.goOn();
    return [...this.roles].map(([client, role]) => [
      client,
      role === 'participant' ? this.forParticipant() : this.forExperimenter(force_n),
    ]);
  }

  // ---- for tests and pictures

  /** Skips to the next screen of a phase; the simulated participant responds to all questions on the way. */
  skipTo(phase: Phase, times = 1): void {
    for (let i = 0; i < times; ++i) {
      this.goOnAnswering();
      while (this.screen.message.phase !== phase && this.at + 1 < this.screens.length) this.goOnAnswering();
    }
  }

  get phase(): Phase {
    return this.ended ? 'stopped' : this.withdrawn ? 'withdrawn' : this.paused ? 'paused' : this.screen.message.phase;
  }

  get given(): readonly Answer[] {
    return this.answers;
  }

  get written(): readonly Note[] {
    return this.notes;
  }

  // ---- commands

  private obeyParticipant(command: StudyCommand): string | null {
    if (this.paused && command.act !== 'quit') return 'the study is paused';
    const { phase } = this.screen.message;
    switch (command.act) {
      case 'go':
        if (this.button === null) return '"Continue" is not available now';
        this.goOn();
        return null;
      case 'fill':
        if (phase !== 'form') return 'no form is shown';
        this.filled.push(command.values);
        this.goOn();
        return null;
      case 'answer':
        if (phase !== 'question') return 'no question is shown';
        this.answer(command.choice === 1, this.elapsed_s);
        this.goOn();
        return null;
      case 'quit':
        this.withdrawn = true;
        this.note('program', 'The participant has withdrawn.');
        return null;
      default:
        return `a participant may not ${command.act}`;
    }
  }

  endForToday(): void {
    this.ended = true;
  }

  private obeyExperimenter(command: StudyCommand): string | null {
    switch (command.act) {
      case 'pause':
      case 'resume':
        this.paused = command.act === 'pause';
        this.begun_ms = Date.now();
        this.note(command.act, this.paused ? 'Paused.' : 'Went on.');
        return null;
      case 'repeat':
        return this.repeat(command.reason);
      case 'note':
        this.note('note', command.text);
        return null;
      case 'end':
        this.note('program', 'Ended for today.');
        this.endForToday();
        return null;
      default:
        return `an experimenter may not ${command.act}`;
    }
  }

  private repeat(reason: string): string | null {
    const under_way = this.screen.trial;
    const last = this.answers.at(-1);
    const trial =
      under_way ??
      this.screens
        .slice(0, this.at)
        .reverse()
        .find((screen) => screen.trial)?.trial;
    if (!trial) return 'no trial has begun';
    if (!under_way && last) Object.assign(last, { state: 'repeated', reason });
    else this.answers.push({ ...this.emptyAnswer(trial), state: 'repeated', reason });
    if (under_way) while (this.screen.trial === trial) ++this.at;
    this.screens.splice(this.at, 0, ...this.trialScreens(trial));
    this.begun_ms = Date.now();
    return null;
  }

  private answer(positive: boolean, reaction_s: number): void {
    const trial = this.screen.trial!;
    const correct = positive === trial.test[1] > BLOCKS[trial.block]!.reference[1];
    this.answers.push({ ...this.emptyAnswer(trial), positive, correct, reaction_s });
    const feedback = this.screens[this.at + 1];
    if (feedback?.message.phase === 'feedback') feedback.message.feedback = correct ? 'right' : 'wrong';
  }

  private emptyAnswer({ number, block, kind, test }: Trial): Answer {
    return {
      trial: number,
      block: BLOCKS[block]!.name,
      kind,
      test: test[0],
      value: test[1],
      positive: null,
      correct: null,
      work: null,
      reaction_s: null,
      state: 'answered',
      reason: '',
    };
  }

  private underWay(): Answer[] {
    const { trial, message } = this.screen;
    return trial && message.phase !== 'feedback' ? [{ ...this.emptyAnswer(trial), state: 'begun' }] : [];
  }

  private note(kind: string, text: string): void {
    this.notes.push({ at: new Date().toISOString(), kind, text });
  }

  // ---- course of the study

  private get screen(): Screen {
    return this.screens[this.at]!;
  }

  private get elapsed_s(): number {
    return (Date.now() - this.begun_ms) / 1000;
  }

  private get button(): string | null {
    const { message, button_after_s } = this.screen;
    return this.elapsed_s >= (button_after_s ?? 0) ? (message.button ?? null) : null;
  }

  private goOn(): void {
    if (this.at + 1 < this.screens.length) ++this.at;
    this.begun_ms = Date.now();
    if (this.screen.message.phase === 'preparing') this.peak_n = 0;
  }

  private goOnAnswering(): void {
    const { trial, message } = this.screen;
    if (trial && message.phase === 'question') {
      const more = shareOfMore(BLOCKS[trial.block]!, trial.test[1]);
      const noise = ((this.answers.length * 3 + 5) % 10) / 10 + 0.05;
      this.answer(noise < more, 0.6 + 0.17 * ((this.answers.length * 3) % 9));
    }
    this.goOn();
  }

  private allScreens(): Screen[] {
    const { break_s } = this.options;
    const blocks = BLOCKS.flatMap((block, i): Screen[] => [
      { message: { phase: 'instructions', text: block.instructions, button: 'Begin' }, block: i },
      ...trialsOf(i).flatMap((trial) => this.trialScreens(trial)),
      {
        message: {
          phase: 'form',
          title: 'How was it?',
          text: 'Click or use the arrow keys on each line.',
          fields: NASA_TLX,
        },
        block: i,
      },
    ]);
    const second = blocks.findIndex(({ block }) => block === 1);
    blocks.splice(second, 0, {
      message: { phase: 'break', text: 'Let go of the handle, and rest your hand.', button: 'Continue' },
      block: 0,
      button_after_s: break_s,
    });
    return [
      {
        message: {
          phase: 'consent',
          title: 'Welcome',
          text:
            'In this study you feel soils as they would be on other worlds, two at a time, and say which had more of something. ' +
            'It takes about 40 minutes, with breaks.\n\nYour answers are kept under a code, not under your name. ' +
            'You may stop at any time, without saying why.',
          button: 'I agree and begin',
        },
        block: -1,
      },
      { message: { phase: 'form', title: 'About you', fields: DEMOGRAPHICS }, block: -1 },
      ...blocks,
      { message: { phase: 'finished', text: 'That was all. Thank you for your time and your hands.' }, block: 2 },
    ];
  }

  private trialScreens(trial: Trial): Screen[] {
    const { question, choices } = BLOCKS[trial.block]!;
    const { interval_s, preparing_s, feedback_s, visual, visual_delay_s } = this.options;
    const part = (message: Screen['message'], auto_s?: number): Screen => ({
      message,
      block: trial.block,
      trial,
      auto_s,
    });
    const interval = (which: number, label: string): Screen =>
      part(
        {
          phase: 'interval',
          interval: which,
          intervals: 2,
          label,
          visual,
          visual_delay_s,
          can_dig: true,
          button: 'Continue',
        },
        interval_s,
      );
    return [
      part({ phase: 'preparing' }, preparing_s),
      interval(1, 'First'),
      part({ phase: 'preparing' }, preparing_s),
      interval(2, 'Second'),
      part({ phase: 'question', title: question, choices }),
      ...(trial.kind === 'practice' ? [part({ phase: 'feedback' }, feedback_s)] : []),
    ];
  }

  // ---- messages

  private progress() {
    const { block, trial } = this.screen;
    if (block < 0 || block >= BLOCKS.length) return null;
    return {
      block: block + 1,
      blocks: BLOCKS.length,
      trial: trial?.number ?? 0,
      trials: BLOCKS[block]!.levels.length * REPEATS + 2,
    };
  }

  private forParticipant(): ParticipantMessage {
    const { message, auto_s, button_after_s } = this.screen;
    const head = { ...waiting(''), study: 'Friction and gravity', progress: this.progress(), problem: null };
    if (this.ended || this.withdrawn || this.paused) return { ...head, phase: this.phase, ended: this.ended };
    const until_s = message.phase === 'interval' ? auto_s : button_after_s;
    return {
      ...head,
      ...message,
      button: this.button,
      remaining_s: until_s === undefined || this.elapsed_s >= until_s ? null : until_s - this.elapsed_s,
    };
  }

  private forExperimenter(force_n: number): ExperimenterMessage {
    const { trial } = this.screen;
    const next = this.screens.slice(this.at).find((screen) => screen.trial && screen.trial !== trial)?.trial;
    return {
      type: 'study',
      as: 'experimenter',
      study: 'Friction and gravity',
      file: 'friction-and-gravity.study',
      participant: 'S01',
      group: 'seen',
      phase: this.phase,
      paused: this.paused,
      progress: this.progress(),
      now: trial ? this.shown(trial) : null,
      next: next ? { ...this.shown(next), interval: 0 } : null,
      force_n,
      peak_force_n: this.peak_n,
      answers: [...this.answers, ...this.underWay()].slice(-100),
      blocks: BLOCKS.map((block) => this.result(block)),
      notes: this.notes,
      ended: this.ended ? ENDED : null,
      problem: this.problem,
    };
  }

  private shown({ block, kind, test }: Trial): TrialShown {
    const { name, question, reference } = BLOCKS[block]!;
    return {
      kind,
      block: name,
      question,
      reference: reference[0],
      test: test[0],
      value: test[1],
      test_first: false,
      interval: this.screen.message.interval ?? 0,
    };
  }

  private result(block: Block): BlockResult {
    const counted = this.answers.filter(
      (answer) => answer.block === block.name && answer.kind === 'main' && answer.state === 'answered',
    );
    const levels = block.levels.map(([, x]) => {
      const here = counted.filter((answer) => answer.value === x);
      return { x, k: here.filter((answer) => answer.positive).length, n: here.length };
    });
    const enough = counted.length >= ENOUGH_FOR_A_CURVE;
    const low = block.levels[0]![1];
    const high = block.levels.at(-1)![1];
    const curve = Array.from({ length: 61 }, (_, i): [number, number] => {
      const x = low * (high / low) ** (i / 60);
      return [x, shareOfMore(block, x)];
    });
    return {
      name: block.name,
      axis_label: block.axis_label,
      log_axis: true,
      reference: block.reference[1],
      levels,
      curve: enough ? curve : null,
      threshold: enough ? block.reference[1] * 1.03 : null,
      weber_fraction: enough ? 10 ** (1.1 / block.slope) - 1 : null,
    };
  }
}

function shareOfMore({ reference, slope }: Block, x: number): number {
  return 1 / (1 + Math.exp(-slope * Math.log10(x / (1.03 * reference[1]))));
}

/** Returns each level three times in a fixed, irregular order, after a practice trial; one catch trial. */
function trialsOf(block: number): Trial[] {
  const { levels } = BLOCKS[block]!;
  const main = Array.from({ length: levels.length * REPEATS }, (_, i) => levels[(i * 7 + 3 * block) % levels.length]!);
  const order = main.map((_, i) => main[(i * 4 + 1) % main.length]!);
  const tests: [TrialKind, [string, number]][] = [
    ['practice', levels.at(-1)!],
    ...order.map((test): [TrialKind, [string, number]] => ['main', test]),
    ['catch', levels.at(-1)!],
  ];
  return tests.map(([kind, test], i) => ({ block, kind, test, number: i + 1 }));
}
