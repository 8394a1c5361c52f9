// The soil in a worker of this page, in place of a remote program with a WebSocket.

import type { Program, Socket } from '../connection';
import type { DemoScene, FromWorker, ToWorker } from './messages';

interface Listener {
  opened(scenes: DemoScene[]): void;
  settling(time_s: number): void;
  /** the worker does not run, and will not */
  failed(why: string): void;
}

const LONGEST_TIMER_MS = 2 ** 31 - 1;

export class WorkerProgram implements Program {
  /** a worker reports its failure, and is silent while soil settles */
  readonly longest_silence_ms = LONGEST_TIMER_MS;
  readonly recordingAddress = null;
  private worker: Worker | null = null;
  private readonly uploads: ((number: number) => void)[] = [];
  private readonly asked: ((changes: string) => void)[] = [];

  constructor(
    private readonly scene: string,
    private readonly made_of: string,
    private readonly listener: Listener,
  ) {}

  connect(): Socket {
    this.worker = new Worker(new URL('./worker.ts', import.meta.url));
    const { worker } = this;
    const socket: Socket & { readyState: number } = {
      binaryType: 'arraybuffer',
      readyState: 0,
      onopen: null,
      onmessage: null,
      onclose: null,
      send: (text) => this.tell({ do: 'hear', text: String(text) }),
      close: () => worker.terminate(),
    };
    worker.onerror = (event) => this.listener.failed(event.message || 'the simulation worker did not start');
    worker.onmessage = ({ data }: MessageEvent<FromWorker | string | ArrayBuffer>) => {
      if (typeof data === 'string' || data instanceof ArrayBuffer) {
        socket.readyState = 1;
        socket.onmessage?.(new MessageEvent('message', { data }));
        this.tell({ do: 'took' });
      } else {
        this.hear(data);
      }
    };
    this.tell({ do: 'open', scene: this.scene, changes: this.made_of });
    return socket;
  }

  whyNotReached(): Promise<string | null> {
    return Promise.resolve(null);
  }

  async upload(file: Blob): Promise<number> {
    const bytes = await file.arrayBuffer();
    return new Promise((resolve) => {
      this.uploads.push(resolve);
      this.worker?.postMessage({ do: 'upload', bytes } satisfies ToWorker, [bytes]);
    });
  }

  /** Returns the changes from the opened scene to the current one, one per line. */
  changes(): Promise<string> {
    return new Promise((resolve) => {
      this.asked.push(resolve);
      this.tell({ do: 'changes' });
    });
  }

  private tell(message: ToWorker): void {
    this.worker?.postMessage(message);
  }

  private hear(message: FromWorker): void {
    switch (message.is) {
      case 'opened':
        return this.listener.opened(message.scenes);
      case 'settling':
        return this.listener.settling(message.time_s);
      case 'failed':
        return this.listener.failed(message.why);
      case 'uploaded':
        return this.uploads.shift()?.(message.number);
      case 'changes':
        return this.asked.shift()?.(message.text);
    }
  }
}
