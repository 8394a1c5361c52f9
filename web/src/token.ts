// The access token that the program printed with the address. It is stored for this tab only, so that the page can be
// reloaded. It is removed from the address bar, where a bystander could read it, and from the history.

const KEY = 'haptolith.token';

export function takeToken(
  at: Pick<Location, 'href'>,
  history: Pick<History, 'state' | 'replaceState'>,
  storage: () => Pick<Storage, 'getItem' | 'setItem'>,
): string | null {
  const address = new URL(at.href);
  const token = address.searchParams.get('token');
  try {
    if (token === null) return storage().getItem(KEY);
    storage().setItem(KEY, token);
  } catch {
    return token; // storage can be forbidden: then the address is unchanged
  }
  address.searchParams.delete('token');
  history.replaceState(history.state, '', address);
  return token;
}
