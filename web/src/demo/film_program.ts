// An animation in place of a program: plays in real time, and supports seeking.

import type { Frame, Scene, Status } from 'haptolith-protocol';
import { decodeFrame, decodeMessage } from 'haptolith-protocol';
import type { Program, Socket } from '../connection';
import { type Film, FilmPictures } from './film';

const BETWEEN_PICTURES_MS = 16;
const STATUS_MS = 250;
const LONGEST_TIMER_MS = 2 ** 31 - 1;

export class FilmProgram implements Program {
  readonly longest_silence_ms = LONGEST_TIMER_MS;
  readonly recordingAddress = null;
  readonly start_s: number;
  readonly end_s: number;
  playing = true;
  /** called when time has advanced */
  onTime: (time_s: number) => void = () => {};
  private socket: (Socket & { readyState: number }) | null = null;
  private pictures: FilmPictures;
  private shown = -1;
  private now_s: number;
  private last_ms = 0;
  private status_ms = -Infinity;

  constructor(private readonly film: Film) {
    this.start_s = film.frames[0]!.time_s;
    this.end_s = film.frames.at(-1)!.time_s;
    this.now_s = this.start_s;
    this.pictures = new FilmPictures(film);
  }

  get time_s(): number {
    return this.now_s;
  }

  connect(): Socket {
    const socket: Socket & { readyState: number } = {
      binaryType: 'arraybuffer',
      readyState: 1,
      onopen: null,
      onmessage: null,
      onclose: null,
      send: () => {}, // commands are ignored
      close: () => clearInterval(timer),
    };
    this.socket = socket;
    this.last_ms = performance.now();
    const timer = setInterval(() => this.turn(), BETWEEN_PICTURES_MS);
    setTimeout(() => this.film.texts.forEach((text) => this.post(text)));
    return socket;
  }

  whyNotReached(): Promise<string | null> {
    return Promise.resolve(null);
  }

  upload(): Promise<number> {
    return Promise.reject(new Error('An animation does not accept files.'));
  }

  /** Jumps to a time, and stays paused or continues to play. */
  seek(time_s: number): void {
    const back = time_s < this.now_s;
    this.now_s = Math.min(this.end_s, Math.max(this.start_s, time_s));
    if (back) this.post(this.film.texts[0]!); // plots restart
    this.show(true);
  }

  toggle(): void {
    this.playing = !this.playing;
    if (this.playing && this.now_s >= this.end_s) this.seek(this.start_s);
  }

  private turn(): void {
    const now_ms = performance.now();
    if (this.playing) {
      this.now_s += (now_ms - this.last_ms) / 1000;
      if (this.now_s >= this.end_s) {
        this.now_s = this.end_s;
        this.playing = false;
      }
    }
    this.last_ms = now_ms;
    this.show(false);
    if (now_ms - this.status_ms > STATUS_MS) {
      this.status_ms = now_ms;
      this.post(JSON.stringify(this.status()));
    }
  }

  private show(anew: boolean): void {
    const { frames } = this.film;
    let index = this.shown;
    if (index < 0 || frames[index]!.time_s > this.now_s) index = 0;
    while (index + 1 < frames.length && frames[index + 1]!.time_s <= this.now_s) ++index;
    if (index !== this.shown || anew) {
      this.shown = index;
      this.post(this.pictures.whole(index));
    }
    this.onTime(this.now_s);
  }

  private post(data: string | ArrayBuffer): void {
    this.socket?.onmessage?.(new MessageEvent('message', { data }));
  }

  /** Returns the status of a finished run, as far as it is known. */
  private status(): Status {
    const frame: Frame = decodeFrame(this.film.frames[Math.max(0, this.shown)]!.bytes);
    const scene = this.film.texts.map(decodeMessage).find((message): message is Scene => message?.type === 'scene');
    return {
      type: 'status',
      time_s: frame.time_s,
      ticks: 0,
      misses: 0,
      misses_too_long: 0,
      misses_woken_late: 0,
      misses_preempted: 0,
      success_rate: 1,
      rate_hz: 1000,
      tick_us: { p50: 0, p99: 0, max: 0 },
      particles: frame.particles,
      awake: frame.awake,
      paused: !this.playing,
      speed: 1,
      held_by: null,
      clients: 1,
      device: `animation of ${scene?.title ?? 'a run'}`,
      person_feels: false,
      let_go: null,
      real_time: { scheduler: null, memory_locked: false },
      simd: '',
      threads: 1,
      busy: null,
      problem: null,
      can_undo: false,
      undo: null,
      undo_redoes: false,
      recording: null,
      recorded: null,
      robot: null,
    };
  }
}
