-- SPDX-License-Identifier: BSD-3-Clause
--
-- The two engines of the framed protocol, between which a core chooses: `framed` and `framed_small`.

package engine_pkg is

  type engine_t is (engine_fast, engine_small);

  -- What an engine is called, for benches.
  function engine_of(text : string) return engine_t;

end package;

package body engine_pkg is

  function engine_of(text : string) return engine_t is
  begin
    if text = "small" then
      return engine_small;
    end if;
    assert text = "fast" report "engine_pkg: no engine is called " & text severity failure;
    return engine_fast;
  end function;

end package body;
