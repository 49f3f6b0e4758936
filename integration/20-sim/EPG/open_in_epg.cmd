@echo off
rem 20-sim runs this in the folder of the export, in which it has put it.  No token stands in it: a folder's name
rem may hold any character.  XXSIM_SCRIPT_MODE is 1 when a script of 20-sim exports: nobody looks at a window then.
if not "%~1"=="window" if not "%XXSIM_SCRIPT_MODE%"=="1" (
    start "Embedded-Project Generator" /d "%~dp0." cmd /k .\open_in_epg.cmd window
    exit /b 0
)
setlocal
set "epg_command="
call py -3 -m epg --version >nul 2>nul
if not errorlevel 1 set "epg_command=py -3 -m epg"
call epg --version >nul 2>nul
if not errorlevel 1 set "epg_command=epg"
if not defined epg_command (
    echo EPG is not installed on this computer, or not in the PATH.
    echo Install Python from python.org, then EPG, and start this file again:
    echo "%~f0"
    if exist "%~dp0ModelConfiguration.xml" echo ModelConfiguration.xml in this folder names your model file and 20-sim license until then.
    exit /b 4
)
%epg_command% exported "%~dp0."
