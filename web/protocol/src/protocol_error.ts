/** A message that does not follow the protocol. */
export class ProtocolError extends Error {
  override name = 'ProtocolError';
}
