// Connection to the program or worker that runs the soil: opens, reopens after a failure, and matches replies to
// commands.

import {
  type Command,
  decodeFrame,
  decodeMessage,
  encodeCommand,
  type Frame,
  type Hello,
  type Scene,
  type Status,
  type StudyMessage,
  SUBPROTOCOL,
} from 'haptolith-protocol';
import * as v from 'valibot';

export interface Listener {
  hello(hello: Hello): void;
  scene(scene: Scene): void;
  status(status: Status): void;
  frame(frame: Frame): void;
  /** absent: this page takes no part in studies */
  study?(message: StudyMessage): void;
  /** `connected` is true after a hello; otherwise `why` gives the reason, in words for a person */
  link(connected: boolean, why: string | null): void;
  /** a message could not be decoded */
  damaged(error: unknown): void;
}

/** A WebSocket, or an object with its interface. */
export type Socket = Pick<WebSocket, 'binaryType' | 'readyState' | 'send' | 'close'> & {
  onopen: ((event: Event) => void) | null;
  onmessage: ((event: MessageEvent<ArrayBuffer | string>) => void) | null;
  onclose: ((event: CloseEvent) => void) | null;
};

/** Program that runs the soil: remote, or a worker of this page. */
export interface Program {
  connect(): Socket;
  /** reason why it could not be reached, in words for a person; null: unknown */
  whyNotReached(): Promise<string | null>;
  /** silence in ms after which it counts as lost */
  readonly longest_silence_ms: number;
  /** uploads a file; returns the number with which a command refers to it; @throws Error in words for a person */
  upload(file: Blob): Promise<number>;
  /** address for the download of a recording; null: recordings are not supported */
  recordingAddress: ((file: string) => string) | null;
}

/** The program refused a command, or could not be reached. */
export class CommandError extends Error {
  override name = 'CommandError';
}

const FIRST_RETRY_MS = 250;
const LONGEST_RETRY_MS = 4000;
const OPEN = 1; // value of readyState
// A half-open connection appears alive for minutes. The program sends a status four times a second, so 8 s of silence
// mean that the connection is lost.
const SILENCE_MS = 8000;
/** a page that is drawn for a picture receives nothing while it draws, however long that takes */
export const SILENCE_FOR_PICTURES_MS = 3_600_000;
const Uploaded = v.object({ upload: v.number() });

export const NO_TOKEN = 'access token missing: open the address that the program printed';

export function socketAddress(location: Location, token: string | null): string {
  const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
  const query = token === null ? '' : `?token=${encodeURIComponent(token)}`;
  return `${scheme}//${location.host}/ws${query}`;
}

/** `haptolith run` and similar programs, by the address of their WebSocket. */
export class ServedProgram implements Program {
  constructor(
    private readonly address: string,
    readonly longest_silence_ms = SILENCE_MS,
  ) {}

  connect(): Socket {
    return new WebSocket(this.address, SUBPROTOCOL);
  }

  /** Asks the same address by an ordinary request, because browsers do not report why a WebSocket failed to open. */
  async whyNotReached(): Promise<string | null> {
    try {
      const { status } = await fetch(this.address.replace(/^ws/, 'http'), { cache: 'no-store' });
      if (status === 401) return NO_TOKEN;
      if (status === 429) return 'too many wrong tokens from this address';
    } catch {
      // no program at this address
    }
    return null;
  }

  async upload(file: Blob): Promise<number> {
    const answer = await fetch(this.beside('/upload'), { method: 'PUT', body: file });
    if (!answer.ok) throw new Error(`Upload failed: ${(await answer.text()).trim()}.`);
    return v.parse(Uploaded, await answer.json()).upload;
  }

  readonly recordingAddress = (file: string): string => this.beside(`/recordings/${encodeURIComponent(file)}`);

  private beside(path: string): string {
    const address = new URL(this.address.replace(/^ws/, 'http'));
    address.pathname = path;
    return address.href;
  }
}

export class Connection {
  private socket: Socket | null = null;
  private next_id = 1;
  private retry_ms = FIRST_RETRY_MS;
  private retry_timer = 0;
  private silence_timer = 0;
  private closed = false;
  private opened = false;
  private readonly waiting = new Map<number, { resolve: () => void; reject: (error: Error) => void }>();

  constructor(
    private readonly program: Program,
    private readonly listener: Listener,
  ) {}

  open(): void {
    const socket = this.program.connect();
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => (this.opened = true);
    this.opened = false;
    this.socket = socket;
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = (event) => this.lost(socket, event);
    this.watchForSilence();
  }

  close(): void {
    this.closed = true;
    clearTimeout(this.retry_timer);
    clearTimeout(this.silence_timer);
    this.socket?.close();
  }

  /** Retries immediately, for instance when the page becomes visible or the user presses the button. */
  retryNow(): void {
    if (this.closed || this.socket) return;
    clearTimeout(this.retry_timer);
    this.open();
  }

  get connected(): boolean {
    return this.socket?.readyState === OPEN;
  }

  /** Sends a command; resolves when the program accepts it, rejects with its message when it does not. */
  request(command: Command): Promise<void> {
    if (!this.connected) return Promise.reject(new CommandError('not connected to the program'));
    const id = this.next_id++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.socket!.send(encodeCommand(command, id));
    });
  }

  /** Sends a command that needs no reply: the poses of a hold, 60 times per second. */
  send(command: Command): void {
    if (this.connected) this.socket!.send(encodeCommand(command));
  }

  private receive(data: ArrayBuffer | string): void {
    this.watchForSilence();
    try {
      if (typeof data === 'string') this.receiveText(data);
      else this.listener.frame(decodeFrame(data));
    } catch (error) {
      this.listener.damaged(error);
    }
  }

  private receiveText(text: string): void {
    const message = decodeMessage(text);
    switch (message?.type) {
      case 'hello':
        this.retry_ms = FIRST_RETRY_MS;
        this.listener.link(true, null);
        return this.listener.hello(message);
      case 'scene':
        return this.listener.scene(message);
      case 'status':
        return this.listener.status(message);
      case 'study':
        return this.listener.study?.(message);
      case 'reply': {
        if (message.id === null) return;
        const waiting = this.waiting.get(message.id);
        this.waiting.delete(message.id);
        if (message.ok) waiting?.resolve();
        else waiting?.reject(new CommandError(message.error ?? 'the program refused'));
      }
    }
  }

  private lost(socket: Socket, event: CloseEvent): void {
    if (socket !== this.socket) return;
    this.socket = null;
    clearTimeout(this.silence_timer);
    for (const { reject } of this.waiting.values()) reject(new CommandError('the connection was lost'));
    this.waiting.clear();
    if (this.closed) return;
    const refused = event.code === 1008 || event.code === 1009 || event.code === 1003;
    const why = refused ? `the program ended the connection (${event.reason || event.code})` : 'connection lost';
    this.listener.link(false, why);
    if (!this.opened)
      void this.program.whyNotReached().then((reason) => {
        if (reason !== null && !this.connected) this.listener.link(false, reason);
      });
    this.retry_timer = window.setTimeout(() => this.open(), this.retry_ms);
    this.retry_ms = Math.min(LONGEST_RETRY_MS, this.retry_ms * 1.6);
  }

  private watchForSilence(): void {
    clearTimeout(this.silence_timer);
    this.silence_timer = window.setTimeout(() => {
      const socket = this.socket;
      socket?.close();
      // A half-open socket may take long to report its end; do not wait for it.
      if (socket) this.lost(socket, new CloseEvent('close', { code: 1006 }));
    }, this.program.longest_silence_ms);
  }
}
