/** A message that is none of the protocol's. */
export class ProtocolError extends Error {
  override name = 'ProtocolError';
}
