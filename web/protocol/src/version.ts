// Version of docs/reference/web-protocol.md.

export const PROTOCOL_VERSION = 1;
export const SUBPROTOCOL = 'haptolith.1';
