-- Starts the language server in Scenic programs, unless `vim.g.scenic_no_lsp` is set.
if vim.g.loaded_scenic then
  return
end
vim.g.loaded_scenic = true

vim.api.nvim_create_autocmd("FileType", {
  pattern = "scenic",
  group = vim.api.nvim_create_augroup("scenic", {}),
  callback = function(event)
    if not vim.g.scenic_no_lsp then
      require("scenic").start(event.buf)
    end
  end,
})

vim.api.nvim_create_user_command("ScenicShow", function(command)
  require("scenic").show(tonumber(command.args))
end, { nargs = "?", desc = "Sample a scene of the program, and show it in the browser" })

vim.api.nvim_create_user_command("ScenicSample", function(command)
  require("scenic").sample(tonumber(command.args))
end, { nargs = "?", desc = "Sample several scenes of the program, and show them in the browser" })

vim.api.nvim_create_user_command("ScenicSimulate", function(command)
  require("scenic").simulate(tonumber(command.args))
end, { nargs = "?", desc = "Save the program, simulate it, and show that in the browser" })

vim.api.nvim_create_user_command("ScenicRestart", function()
  require("scenic").restart()
end, { desc = "Restart Scenic's language server" })
