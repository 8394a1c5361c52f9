// Animation files (films): `haptolith export --format film` writes the protocol messages of a recording in sequence
// (docs/reference/web-messages.md).

import { decodeFrame, HEADER_BYTES, RECORD_BYTES, RUN_BYTES } from 'haptolith-protocol';

const MAGIC = 'haptolith film 1';
const TEXT = 1;
const FRAME = 2;
const FLAG_WHOLE = 4;
const HEAD_BYTES = 5; // header of a message: length and kind

export interface Film {
  /** hello and scene */
  texts: string[];
  frames: { time_s: number; bytes: ArrayBuffer }[];
}

/** @throws Error in words for a person */
export function readFilm(bytes: ArrayBuffer): Film {
  const text_of = new TextDecoder();
  if (text_of.decode(bytes.slice(0, MAGIC.length)) !== MAGIC)
    throw new Error('not an animation: make one with haptolith export RUN.h5 --format film');
  const film: Film = { texts: [], frames: [] };
  const view = new DataView(bytes);
  let at = MAGIC.length;
  while (at < bytes.byteLength) {
    const size = at + HEAD_BYTES <= bytes.byteLength ? view.getUint32(at, true) : Infinity;
    if (at + HEAD_BYTES + size > bytes.byteLength) break; // a truncated file keeps the complete messages
    const kind = view.getUint8(at + 4);
    const message = bytes.slice(at + HEAD_BYTES, at + HEAD_BYTES + size);
    if (kind === TEXT) film.texts.push(text_of.decode(message));
    else if (kind === FRAME) film.frames.push({ time_s: decodeFrame(message).time_s, bytes: message });
    at += HEAD_BYTES + size;
  }
  if (film.texts.length === 0 || film.frames.length === 0) throw new Error('the animation has no frames');
  return film;
}

/** Assembles complete frames from frames that contain only changes. */
export class FilmPictures {
  private readonly records: Uint16Array;
  private next = 0;

  constructor(private readonly film: Film) {
    this.records = new Uint16Array(4 * decodeFrame(film.frames[0]!.bytes).particles);
  }

  /** Returns frame number `index` with all its particles. */
  whole(index: number): ArrayBuffer {
    if (index < this.next - 1) this.next = 0;
    for (; this.next <= index; ++this.next) this.take(this.film.frames[this.next]!.bytes);
    const bytes = this.film.frames[index]!.bytes;
    const { stones, particles } = decodeFrame(bytes);
    const records_at = HEADER_BYTES + RUN_BYTES;
    const stones_at = records_at + particles * RECORD_BYTES;
    const stone_bytes = stones.length > 0 ? 4 + stones.byteLength : 0;
    const whole = new Uint8Array(stones_at + stone_bytes);
    whole.set(new Uint8Array(bytes, 0, HEADER_BYTES));
    whole.set(new Uint8Array(this.records.buffer), records_at);
    whole.set(new Uint8Array(bytes, bytes.byteLength - stone_bytes, stone_bytes), stones_at);
    const view = new DataView(whole.buffer);
    view.setUint16(2, view.getUint16(2, true) | FLAG_WHOLE, true);
    view.setUint32(112, 1, true); // runs
    view.setUint32(116, particles, true); // records
    view.setUint32(HEADER_BYTES, 0, true);
    view.setUint32(HEADER_BYTES + 4, particles, true);
    return whole.buffer;
  }

  private take(bytes: ArrayBuffer): void {
    const { runs, records } = decodeFrame(bytes);
    let from = 0;
    for (let run = 0; run < runs.length; run += 2) {
      const count = 4 * runs[run + 1]!;
      this.records.set(records.subarray(from, from + count), 4 * runs[run]!);
      from += count;
    }
  }
}
