// Connects to a running haptolith, as the page does, and prints the number of frames, the number of particles, and the
// maximum force. Exit status 1: no connection, or a damaged message.
//
//     haptolith run icra2021 --motion scoop --port 8080        in one terminal
//     node watch.mjs --address ws://127.0.0.1:8080/ws       in another, where haptolith-protocol is installed (docs/reference/web-protocol.md)
//
// Options: --address, --seconds 5, and --token TEXT if the program requires one.

import { decodeFrame, decodeMessage, encodeCommand, SUBPROTOCOL } from 'haptolith-protocol';
import { parseArgs } from 'node:util';

// Node has a built-in WebSocket since version 22. Neither sends an Origin, so the program does not treat it as a page.
const Socket = globalThis.WebSocket ?? (await import('ws')).default;

const { values: options } = parseArgs({
  options: {
    address: { type: 'string', default: 'ws://127.0.0.1:8080/ws' },
    seconds: { type: 'string', default: '5' },
    token: { type: 'string' },
  },
});

const address = new URL(options.address);
if (options.token !== undefined) address.searchParams.set('token', options.token);
const socket = new Socket(address, SUBPROTOCOL);
socket.binaryType = 'arraybuffer';

let scene = null;
let newest = null;
let frames = 0;
let strongest_n = 0;

function readText(text) {
  const message = decodeMessage(text); // null: message of a later version
  switch (message?.type) {
    case 'hello':
      console.log(`haptolith ${message.version}, this is client ${message.client}`);
      break;
    case 'scene':
      scene = message;
      console.log(`${scene.title}: ${scene.particles} particles`);
      break;
    case 'reply':
      if (!message.ok) console.log(`refused: ${message.error}`);
  }
}

function readFrame(bytes) {
  newest = decodeFrame(bytes);
  ++frames;
  strongest_n = Math.max(strongest_n, Math.hypot(...newest.force_n));
}

socket.onopen = () => {
  socket.send(encodeCommand({ do: 'colour', by: 'force' }, 1)); // include contact forces in the records
  setTimeout(() => socket.close(), Number(options.seconds) * 1000);
};
socket.onmessage = ({ data }) => {
  try {
    if (typeof data === 'string') readText(data);
    else readFrame(data);
  } catch (error) {
    console.error(`a damaged message: ${error.message}`);
    process.exit(1);
  }
};
socket.onerror = ({ message }) => console.error(`no connection: ${message || 'nobody listens there, or it wants a token'}`);
socket.onclose = ({ code, reason }) => {
  if (newest === null || scene === null) {
    console.error(`nothing came (${code} ${reason})`);
    process.exit(1);
  }
  console.log(
    `${frames} frames, the last at ${newest.time_s.toFixed(3)} s: ${newest.particles} particles, ${newest.awake} awake, ` +
      `force ${Math.hypot(...newest.force_n).toFixed(4)} N, strongest ${strongest_n.toFixed(4)} N`,
  );
};
