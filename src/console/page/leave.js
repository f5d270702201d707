// Leaving or hiding the page ends an attended run: ask first, where a browser lets a page ask.

export function start_leaving(connection, dialog) {
  const would_stop = () => connection.operating && connection.mode === 'running' && connection.state.attended;

  window.addEventListener('beforeunload', event => {
    if (!would_stop()) return;
    event.preventDefault();
    event.returnValue = '';
  });

  /// For a click on a link that opens in another tab, which hides this one.
  return async function leave(event, url) {
    if (!would_stop()) return;
    event.preventDefault();
    const yes = await dialog.ask({
      title: 'Stop the run?', lines: ['The report opens in another tab. That hides this page, and an attended run stops.'],
      yes: 'Open the report', no: 'Stay', stale: () => !would_stop(),
    });
    if (yes) window.open(url, '_blank', 'noopener');
  };
}
