// The protocol between haptolith and its page, for other client programs: docs/reference/web-protocol.md, version 1.

export * from './commands.js';
export * from './frame.js';
export * from './messages.js';
export * from './pose.js';
export * from './protocol_error.js';
export * from './stone.js';
export * from './study.js';
export * from './tool_mesh.js';
export * from './triangle_mesh.js';
export * from './version.js';
